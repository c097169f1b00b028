// SPDX-License-Identifier: Apache-2.0
// The page around the view: what stands in the file, colours and their legend, and the vertex that is picked.
'use strict';

(async function () {
  const byId = id => document.getElementById(id);
  const facts = JSON.parse(byId('facts').textContent), report = JSON.parse(byId('report').textContent);

  const {make, inWords, inDigits, lengthIn, STATE_COLOURS} = FIGURES;

  // In words, what each state means.
  const WHY = {
    reached: 'It is at its distance.',
    collision: 'It met the offset of another part of the surface.',
    limited: 'Held back: moving on would invert, collapse or cross faces.',
    outside_field: 'Its path left the grid of the distance field.',
    unused: 'No face uses it; it stays where it is.',
    mitered: 'It moved farther than the distance, to where the planes of its faces meet, so that these faces are at the distance.',
    cut: 'The miter limit stopped it on its way to where the planes of its faces meet.',
  };
  const SHORT = ['collision', 'limited', 'outside_field'], FAR = ['mitered', 'cut'];

  async function unpack() {
    const element = byId('arrays'), binary = atob(element.textContent);
    element.remove();
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
    const buffer = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
    const types = {float32: Float32Array, uint32: Uint32Array, uint8: Uint8Array}, arrays = {};
    for (const [name, {type, at, count}] of Object.entries(facts.arrays)) arrays[name] = new types[type](buffer, at, count);
    return arrays;
  }

  // The faces that are shown of the source, which surfaces have as well, or of a surface that has others.
  function meshOf(arrays, of) {
    return {vertex: arrays[of + 'vertex'], corners: arrays[of + 'corners'], face: arrays[of + 'face'], edges: arrays[of + 'edges'],
            group: arrays[of + 'group'] || null};
  }

  function dataOf(arrays) {
    const source = {positions: arrays['source.positions'], mesh: meshOf(arrays, '')};
    const surfaces = facts.surfaces.map((surface, i) => {
      const of = what => arrays[`surface${i}.${what}`] || null, target = of('target');
      return {
        name: surface.name, mesh: of('corners') ? meshOf(arrays, `surface${i}.`) : source.mesh, positions: of('positions'),
        share: of('share'), state: of('state'), achieved: of('achieved'), error: of('error'),
        target: v => target ? target[v] : surface.target,
        fault: of('fault'), faultFace: of('fault_face'), faultAt: of('fault_at'), faultGroup: of('fault_group'),
      };
    });
    // A mesh alone is shown as a surface is.
    if (isAlone) surfaces.push(Object.assign({name: facts.title}, source));
    return {curves: facts.curves, sizeOfElement: facts.curves ? 2 : 3, source, surfaces};
  }

  // The view and what goes with it.

  const isAlone = facts.surfaces.length === 0;
  const looks = {source: isAlone ? 'hidden' : 'see-through', result: 'solid', up: facts.up, outermost: Infinity, cutAxis: -1, cutAt: 0.5};
  let data, view, modes;

  function paint() {
    const mode = modes[looks.colour], legend = byId('legend');
    data.surfaces.forEach((surface, i) => view.paint(i, mode.colours(surface)));
    legend.replaceChildren();
    if (looks.colour !== 'plain') make('div', legend, mode.title || mode.label);
    mode.legend(legend);
    view.draw();
  }

  const isSurfaceShown = i => looks.result !== 'hidden' && i < looks.outermost && (!looks.only || looks.only[i]);

  function update() {
    byId('transparency').disabled = looks.source !== 'see-through' && looks.result !== 'see-through';
    view.setLook(view.source, looks.source);
    view.surfaces.forEach((surface, i) => {
      const isShown = isSurfaceShown(i);
      view.setLook(surface, isShown ? looks.result : 'hidden');
      view.showEdges(i, isShown && Boolean(looks.edges));
      // Faults are those of the result in its place.
      for (const {points, surface: of, box, isFault} of marks)
        if (of === i) points.visible = isShown && box.checked && !(isFault && view.share < 1);
    });
    view.cut(looks.cutAxis, looks.cutAt);
    view.draw();
  }

  const marks = [];
  // Vertices in these states, as points.
  function addMarks(words, title) {
    const all = facts.surfaces.map((_, i) => i), of = facts.layers ? all.slice(-1) : all;
    const count = of.reduce((sum, i) => sum + facts.states.reduce((n, name, s) =>
        n + (words.includes(name) && facts.surfaces[i].states ? facts.surfaces[i].states[s] : 0), 0), 0);
    if (count === 0) return;
    const label = make('label', byId('controls'), undefined, {class: 'wide'});
    const box = make('input', label, undefined, {type: 'checkbox'});
    label.append(` mark ${title} (${inWords(count)})`);
    box.checked = words === SHORT;
    box.addEventListener('change', update);
    for (const i of of) {
      const {state} = data.surfaces[i];
      if (!state) continue;
      const vertices = Uint32Array.from([...state.keys()].filter(v => words.includes(facts.states[state[v]])));
      const colours = new Uint8Array(3 * vertices.length);
      vertices.forEach((v, k) => {
        const colour = STATE_COLOURS[facts.states[state[v]]];
        [16, 8, 0].forEach((shift, c) => { colours[3 * k + c] = colour >> shift & 255; });
      });
      marks.push({points: view.addMarks(i, vertices, colours), surface: i, box});
    }
  }

  const FAULT_COLOUR = 0xe0007a;
  // In words, what each fault means.
  const WRONG = {
    inverted: 'It faces the wrong way.',
    collapsed: 'Almost none of its area is left.',
    crowded: 'It is nearer to an obstacle than the clearance, or passes through the source.',
    crossing: 'It crosses another face that it does not cross in the source.',
  };

  // Faces that something is wrong with, as points in their middles.
  function addFaults() {
    const count = facts.surfaces.reduce((sum, each) => sum + (each.faults || 0), 0);
    if (count === 0) return;
    const label = make('label', byId('controls'), undefined, {class: 'wide'});
    const box = make('input', label, undefined, {type: 'checkbox', id: 'faults'});
    label.append(` mark faulty faces (${inWords(count)})`);
    box.checked = true;
    box.addEventListener('change', update);
    data.surfaces.forEach((surface, i) => {
      if (!surface.fault) return;
      const colours = new Uint8Array(3 * surface.fault.length);
      for (let k = 0; k < colours.length; ++k) colours[k] = FAULT_COLOUR >> [16, 8, 0][k % 3] & 255;
      marks.push({points: view.addFaultMarks(surface.faultAt, colours, surface.faultGroup), surface: i, box, isFault: true});
    });
    const first = data.surfaces.find(each => each.fault);
    make('li', byId('remarks'), `Faulty: ${[...first.faultFace.slice(0, 12)].map((f, k) =>
        `face ${f} (${facts.faults[first.fault[k]]})`).join(', ')}${count > 12 ? ', …' : ''}`);
  }

  // What is wrong with a face of a surface, if anything is.
  function faultOf(surface, face) {
    const at = surface && surface.faultFace ? surface.faultFace.indexOf(face) : -1;
    return at < 0 ? null : facts.faults[surface.fault[at]];
  }

  function addChoice(title, name, options) {
    make('label', byId('controls'), title, {for: name});
    const select = make('select', byId('controls'), undefined, {id: name});
    for (const [value, text] of options) make('option', select, text, {value});
    select.value = looks[name];
    return select;
  }

  // titleAt(value): the title of the slider where it stands.
  function addRange(titleAt, attributes, onInput) {
    const label = make('label', byId('controls'), titleAt(attributes.value), {for: attributes.id});
    const range = make('input', byId('controls'), undefined, Object.assign({type: 'range'}, attributes));
    range.addEventListener('input', () => {
      label.textContent = titleAt(Number(range.value));
      onInput(Number(range.value));
      update();
    });
    return range;
  }

  function addControls() {
    const ways = ['hidden', 'see-through', 'solid'].map(word => [word, word]);
    const colour = addChoice('colour by', 'colour', Object.entries(modes).map(([name, mode]) => [name, mode.label]));
    colour.addEventListener('change', () => { looks.colour = colour.value; paint(); });
    const names = {source: 'source', result: isAlone ? 'mesh' : facts.layers ? 'layers' : data.surfaces.length > 1 ? 'skins' : data.surfaces[0].name};
    for (const which of isAlone ? ['result'] : ['source', 'result']) {
      const select = addChoice(names[which], which, ways);
      select.addEventListener('change', () => { looks[which] = select.value; update(); });
    }
    addRange(() => 'transparency', {id: 'transparency', min: 0.05, max: 0.95, step: 0.05, value: 0.75}, value => { view.opacity = 1 - value; });
    addSurfaceControls();
    const up = addChoice('up', 'up', ['x', 'y', 'z'].map((name, axis) => [axis, name]));
    up.addEventListener('change', () => view.setUp(Number(up.value)));
    const axis = addChoice('cut open', 'cutAxis', [[-1, 'no'], [0, 'across x'], [1, 'across y'], [2, 'across z']]);
    axis.addEventListener('change', () => {
      looks.cutAxis = Number(axis.value);
      share.disabled = looks.cutAxis < 0;
      update();
    });
    const share = addRange(() => 'cut at', {id: 'cutAt', min: 0, max: 1, step: 0.005, value: looks.cutAt}, value => { looks.cutAt = value; });
    share.disabled = true;
    if (!facts.curves) addBox('edges', false, checked => { looks.edges = checked; });
    addFaults();
    addMarks(SHORT, 'vertices that fall short');
    addMarks(FAR, 'vertices with a miter');
  }

  // Which of several surfaces are shown, and how far along their vertices are.
  function addSurfaceControls() {
    const count = data.surfaces.length;
    if (facts.layers && count > 1)
      addRange(value => `layers shown: ${value}`, {id: 'outermost', min: 0, max: count, step: 1, value: count}, value => { looks.outermost = value; });
    else if (count > 1) {
      looks.only = data.surfaces.map(() => true);
      data.surfaces.forEach((surface, i) => addBox(surface.name, true, checked => { looks.only[i] = checked; }));
    }
    if (isAlone || data.surfaces.every(each => each.mesh !== data.source.mesh)) return;
    const inPercent = value => `moved ${Math.round(100 * value)} %`;
    const range = addRange(inPercent, {id: 'along', min: 0, max: 1, step: 0.01, value: 1}, value => {
      view.setShare(value);
      if (byId('picked').dataset.x !== undefined) notePlace(byId('picked').dataset);
    });
    range.title = 'Moves the vertices straight from the source (0 %) to the result (100 %).';
  }

  function addBox(text, checked, onChange) {
    const label = make('label', byId('controls'), undefined, {class: 'wide'});
    const box = make('input', label, undefined, {type: 'checkbox'});
    box.checked = checked;
    label.append(' ' + text);
    box.addEventListener('change', () => { onChange(box.checked); update(); });
  }

  // Shows what is known of a vertex, given by its place among those that are drawn.
  function tell(surface, v, element) {
    const list = byId('picked'), on = surface < 0 ? data.source : data.surfaces[surface], number = on.mesh.vertex[v];
    list.replaceChildren();
    Object.assign(list.dataset, {vertex: number, surface, v});
    const row = (name, value) => { make('dt', list, name); make('dd', list, value); };
    row('vertex', String(number));
    row('on', surface < 0 ? 'source' : on.name);
    row('at', [0, 1, 2].map(k => inDigits(on.positions[3 * v + k] + facts.centre[k])).join(', '));
    if (on.share) tellDistances(on, v, row);
    if (element !== undefined) {
      const face = on.mesh.face[element];
      row(facts.curves ? 'curve' : 'face', String(face));
      if (on.error && on.error[element] === on.error[element]) row('its error', `${inDigits(100 * on.error[element])} % of the distance`);
      const fault = faultOf(on, face);
      if (fault) row('its fault', `${fault}: ${WRONG[fault]}`);
      if (on.mesh.group) row('its group', facts.groups[on.mesh.group[element]]);
    }
    byId('number').value = number;
    view.setMark(surface, v);
    list.dataset.camera = JSON.stringify(view.matrix());
  }

  function tellDistances(surface, v, row) {
    row('target', lengthIn(facts, surface.target(v)));
    row('achieved', surface.achieved ? lengthIn(facts, surface.achieved[v]) : 'not measured at this height');
    row('share', surface.share[v] === surface.share[v] ? `${inDigits(100 * surface.share[v])} %` : '–');
    if (!surface.state) return;
    const state = facts.states[surface.state[v]];
    row('state', state);
    row('why', WHY[state]);
  }

  function pickAt(x, y) {
    const found = view.pick(x, y);
    if (found) tell(found.surface, found.vertex, found.element);
    else {
      delete byId('picked').dataset.vertex;
      byId('picked').replaceChildren();
      make('dt', byId('picked'), 'Nothing is there.');
    }
  }

  // The place of a number in an ascending list, or -1.
  function placeOf(number, list) {
    let low = 0, high = list.length;
    while (low < high) {
      const middle = low + high >> 1;
      if (list[middle] < number) low = middle + 1;
      else high = middle;
    }
    return list[low] === number ? low : -1;
  }

  // Goes to a vertex by its number, on the outermost surface.
  function goTo(number) {
    const list = byId('picked'), surface = data.surfaces.length - 1, v = placeOf(number, data.surfaces[surface].mesh.vertex);
    if (v < 0) {
      list.replaceChildren();
      delete list.dataset.vertex;
      make('dt', list, number < facts.vertices ? `Vertex ${number} is not drawn.` : `There is no vertex ${number}.`);
      return;
    }
    tell(surface, v);
    notePlace(list.dataset);
  }

  // Where on the view the picked vertex is.
  function notePlace(picked) { Object.assign(picked, view.place(Number(picked.surface), Number(picked.v))); }

  // #pick=X,Y and #vertex=N, for links to a place.
  function follow() {
    const pick = /^#pick=([\d.]+),([\d.]+)$/.exec(location.hash), vertex = /^#vertex=(\d+)$/.exec(location.hash);
    if (pick) pickAt(Number(pick[1]), Number(pick[2]));
    if (vertex) goTo(Number(vertex[1]));
  }

  function listen() {
    const canvas = byId('view');
    let from = null;
    canvas.addEventListener('pointerdown', event => { from = [event.clientX, event.clientY]; });
    canvas.addEventListener('pointerup', event => {
      const isClick = from && Math.hypot(event.clientX - from[0], event.clientY - from[1]) < 4;
      if (!isClick || event.button !== 0) return;
      const box = canvas.getBoundingClientRect();
      pickAt(event.clientX - box.left, event.clientY - box.top);
    });
    byId('number').addEventListener('change', event => goTo(Number(event.target.value)));
    window.addEventListener('hashchange', follow);
    new ResizeObserver(() => view.resize()).observe(byId('stage'));
    const background = () => { view.setBackground(getComputedStyle(document.documentElement).getPropertyValue('--stage').trim()); view.draw(); };
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', background);
    background();
  }

  const message = byId('message');
  FIGURES.show(facts, report);
  try {
    data = dataOf(await unpack());
    view = new VIEW.View(byId('view'), data, facts.up);
  } catch (error) {
    message.textContent = `No view: ${error.message}. It needs a browser of 2023 or later with WebGL. The figures do not.`;
    document.body.dataset.ready = 'without a view';
    return;
  }
  modes = COLOURS.modes(facts, data);
  // Vertices on sharp edges are farther than the distance, so that the faces between them can be at it.
  const hasMiters = facts.states.some((name, s) => name === 'mitered' && facts.surfaces.some(each => each.states && each.states[s] > 0));
  looks.colour = isAlone && modes.group && facts.groups.length > 1 ? 'group' : hasMiters && modes.error ? 'error' : Object.keys(modes)[0];
  addControls();
  const showAll = make('button', byId('tools'), 'Show all', {type: 'button', title: 'Reset the view (Home)'});
  showAll.addEventListener('click', () => view.showAll());
  PLACES.addWorst(facts, data, view, isSurfaceShown, tell);
  PLACES.addPicture(facts, view);
  PLACES.addGroups(facts, data, view, COLOURS.groupColour, update);
  view.resize();
  view.showAll();
  paint();
  update();
  listen();
  message.textContent = data.source.mesh.face.length === 0 ? 'There is no face to show.' : '';
  follow();
  await view.draw();
  document.body.dataset.ready = Math.round(performance.now());
})();
