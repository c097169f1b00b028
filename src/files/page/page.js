// SPDX-License-Identifier: Apache-2.0
// The page around the view: what stands in the file, colours and their legend, and the vertex that is picked.
'use strict';

(async function () {
  const byId = id => document.getElementById(id);
  const facts = JSON.parse(byId('facts').textContent), report = JSON.parse(byId('report').textContent);

  const {make, inWords, inDigits, css, onRamp, STATE_COLOURS, UNKNOWN, SHARE_RAMP, ERROR_RAMP} = FIGURES;

  // In words, what each state means.
  const WHY = {
    reached: 'It is at its distance.',
    collision: 'The distance grows no further there: the front from the other side was met.',
    limited: 'Held back: going on would invert, collapse or cross faces.',
    outside_field: 'Its path left the grid of the distance field.',
    unused: 'No face uses it; it stays where it is.',
    mitred: 'Where the planes of its faces meet, farther than the distance, so that the faces are at it.',
    cut: 'On the way to where the planes of its faces meet, as far as the miter limit allows.',
  };
  const SHORT = ['collision', 'limited', 'outside_field'], FAR = ['mitred', 'cut'];

  // Around the circle of colours, by the golden angle, so that neighbours differ.
  function groupColour(group) {
    const hue = group * 137.508 % 360, light = [0.6, 0.45, 0.75][group % 3];
    return new THREE.Color().setHSL(hue / 360, 0.55, light).getHex();
  }

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

  function dataOf(arrays) {
    const surfaces = facts.surfaces.map((surface, i) => {
      const of = what => arrays[`surface${i}.${what}`] || null, target = of('target');
      return {
        name: surface.name, positions: of('positions'), share: of('share'), state: of('state'), achieved: of('achieved'),
        error: of('error'), target: v => target ? target[v] : surface.target,
        fault: of('fault'), faultFace: of('fault_face'), faultAt: of('fault_at'),
      };
    });
    return {
      curves: facts.curves, sizeOfElement: facts.curves ? 2 : 3, vertex: arrays.vertex, corners: arrays.corners,
      face: arrays.face, edges: arrays.edges, group: arrays.group || null, source: {positions: arrays['source.positions']},
      surfaces,
    };
  }

  // The view and what goes with it.

  const looks = {source: 'see-through', result: 'solid', colour: 'share', outermost: facts.surfaces.length, cutAxis: -1, cutAt: 0.5};
  let data, view;

  function errorScale() {
    let most = 0;
    for (const {error} of data.surfaces) {
      if (!error) continue;
      const sorted = Float32Array.from(error.filter(e => e === e)).sort();
      if (sorted.length > 0) most = Math.max(most, sorted[Math.floor(0.98 * (sorted.length - 1))]);
    }
    return Math.max(most, 0.01);  // one percent: less is as good as none
  }

  const MODES = {
    share: {
      label: 'share of the distance', has: () => true,
      colours: surface => (element, v) => onRamp(SHARE_RAMP, surface.share[v]),
      legend: to => ramp(to, SHARE_RAMP, 2, ['0', '50 %', '100 %', '', '200 %']),
    },
    state: {
      label: 'state', has: () => data.surfaces.some(each => each.state),
      colours: surface => (element, v) => surface.state ? STATE_COLOURS[facts.states[surface.state[v]]] : UNKNOWN,
      legend: to => stateLegend(to),
    },
    error: {
      label: 'error of faces', has: () => data.surfaces.some(each => each.error),
      colours: surface => {
        const scale = errorScale();
        return element => onRamp(ERROR_RAMP, surface.error ? surface.error[element] / scale : NaN);
      },
      legend: to => {
        const scale = 100 * errorScale();
        ramp(to, ERROR_RAMP, 1, ['0', `${inDigits(Number((scale / 2).toPrecision(2)))} %`, `${inDigits(Number(scale.toPrecision(2)))} % and more`]);
        make('div', to, 'of the distance; grey: not known');
      },
    },
    group: {
      label: 'group', has: () => data.group,
      colours: () => element => groupColour(data.group[element]),
      legend: to => entries(to, facts.groups.map((name, i) => [groupColour(i), name])),
    },
  };

  function ramp(to, colours, end, marks) {
    const bar = make('canvas', to, undefined, {class: 'ramp', width: 260, height: 1});
    const context = bar.getContext('2d');
    for (let x = 0; x < 260; ++x) {
      context.fillStyle = css(onRamp(colours, end * x / 259));
      context.fillRect(x, 0, 1, 1);
    }
    const row = make('div', to, undefined, {class: 'marks'});
    marks.forEach((text, i) => { make('span', row, text).style.left = `${100 * i / (marks.length - 1)}%`; });
  }

  function entries(to, list) {
    const box = make('div', to, undefined, {class: 'entries'});
    for (const [colour, text] of list.slice(0, 60)) {
      const entry = make('span', box);
      make('span', entry, '', {class: 'swatch'}).style.background = css(colour);
      entry.append(text);
    }
    if (list.length > 60) make('span', box, `and ${list.length - 60} more`);
  }

  function stateLegend(to) {
    const counts = facts.states.map((_, s) => facts.surfaces.reduce((sum, each) => sum + (each.states ? each.states[s] : 0), 0));
    // All of the layers have one state.
    const share = facts.layers ? facts.surfaces.length : 1;
    entries(to, facts.states.map((name, s) => [STATE_COLOURS[name], `${name} ${inWords(counts[s] / share)}`, counts[s]]).filter(e => e[2] > 0));
  }

  function paint() {
    const mode = MODES[looks.colour], legend = byId('legend');
    data.surfaces.forEach((surface, i) => view.paint(i, mode.colours(surface)));
    legend.replaceChildren();
    make('div', legend, `${facts.curves ? 'curves' : 'surface'}: ${mode.label}`);
    mode.legend(legend);
    view.draw();
  }

  function update() {
    view.setLook(view.source, looks.source);
    view.surfaces.forEach((surface, i) => {
      const isShown = looks.result !== 'hidden' && i < looks.outermost && (!looks.only || looks.only[i]);
      view.setLook(surface, isShown ? looks.result : 'hidden');
      view.showEdges(i, isShown && Boolean(looks.edges));
      for (const {points, surface: of, box} of marks) if (of === i) points.visible = isShown && box.checked;
    });
    view.cut(looks.cutAxis, looks.cutAt);
    view.draw();
  }

  const marks = [];
  // Vertices in these states, as points.
  function addMarks(words, title) {
    const of = facts.layers ? [data.surfaces.length - 1] : data.surfaces.map((_, i) => i);
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
    collapsed: 'Next to nothing of its area is left.',
    crowded: 'It is nearer to an obstacle than may be, or goes through the source.',
    crossing: 'It crosses another face, which it did not before.',
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
      marks.push({points: view.addPoints(surface.faultAt, colours), surface: i, box});
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

  function addRange(title, attributes, onInput) {
    make('label', byId('controls'), title, {for: attributes.id});
    const range = make('input', byId('controls'), undefined, Object.assign({type: 'range'}, attributes));
    range.addEventListener('input', () => { onInput(Number(range.value), range); update(); });
    return range;
  }

  function addControls() {
    const ways = ['hidden', 'see-through', 'solid'].map(word => [word, word]);
    const colour = addChoice('colour by', 'colour', Object.entries(MODES).filter(([, mode]) => mode.has()).map(([k, mode]) => [k, mode.label]));
    colour.addEventListener('change', () => { looks.colour = colour.value; paint(); });
    const names = {source: 'source', result: facts.layers ? 'layers' : data.surfaces.length > 1 ? 'skins' : 'offset'};
    for (const which of ['source', 'result']) {
      const select = addChoice(names[which], which, ways);
      select.addEventListener('change', () => { looks[which] = select.value; update(); });
    }
    if (facts.layers && data.surfaces.length > 1) {
      const count = data.surfaces.length;
      addRange('layers on', {id: 'outermost', min: 0, max: count, step: 1, value: count}, (value, range) => {
        looks.outermost = value;
        range.setAttribute('aria-valuetext', `${value} of ${count}`);
      });
    } else if (data.surfaces.length > 1) {
      looks.only = data.surfaces.map(() => true);
      data.surfaces.forEach((surface, i) => addBox(surface.name, true, checked => { looks.only[i] = checked; }));
    }
    const axis = addChoice('cut open', 'cutAxis', [[-1, 'not'], [0, 'across x'], [1, 'across y'], [2, 'across z']]);
    axis.addEventListener('change', () => {
      looks.cutAxis = Number(axis.value);
      share.disabled = looks.cutAxis < 0;
      update();
    });
    const share = addRange('cut off', {id: 'cutAt', min: 0, max: 1, step: 0.005, value: looks.cutAt}, value => { looks.cutAt = value; });
    share.disabled = true;
    if (!facts.curves) addBox('edges', false, checked => { looks.edges = checked; });
    addFaults();
    addMarks(SHORT, 'vertices that fall short');
    addMarks(FAR, 'mitred and cut vertices');
  }

  function addBox(text, checked, onChange) {
    const label = make('label', byId('controls'), undefined, {class: 'wide'});
    const box = make('input', label, undefined, {type: 'checkbox'});
    box.checked = checked;
    label.append(' ' + text);
    box.addEventListener('change', () => { onChange(box.checked); update(); });
  }

  // Tells of a vertex, by its place among those that are shown.
  function tell(surface, v, element) {
    const list = byId('picked'), number = data.vertex[v], on = data.surfaces[surface];
    list.replaceChildren();
    list.dataset.vertex = number;
    list.dataset.surface = surface;
    const row = (name, value) => { make('dt', list, name); make('dd', list, value); };
    row('vertex', String(number));
    row('on', surface < 0 ? 'source' : on.name);
    const place = view.position(surface, v).toArray().map((x, k) => inDigits(x + facts.centre[k]));
    row('at', place.join(', '));
    if (surface >= 0) tellDistances(on, v, row);
    if (element !== undefined) {
      row(facts.curves ? 'curve' : 'face', String(data.face[element]));
      if (on && on.error && on.error[element] === on.error[element]) row('its error', `${inDigits(100 * on.error[element])} % of the distance`);
      const fault = faultOf(on, data.face[element]);
      if (fault) row('its fault', `${fault}: ${WRONG[fault]}`);
      if (data.group) row('its group', facts.groups[data.group[element]]);
    }
    byId('number').value = number;
    view.setMark(surface, v);
    list.dataset.camera = JSON.stringify(view.matrix());
  }

  function tellDistances(surface, v, row) {
    row('target', inDigits(surface.target(v)));
    row('achieved', surface.achieved ? inDigits(surface.achieved[v]) : 'not measured at this height');
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
      make('dt', byId('picked'), 'nothing there');
    }
  }

  // Goes to a vertex by its number, on the outermost surface.
  function goTo(number) {
    const list = byId('picked');
    let low = 0, high = data.vertex.length;
    while (low < high) {
      const middle = low + high >> 1;
      if (data.vertex[middle] < number) low = middle + 1;
      else high = middle;
    }
    if (data.vertex[low] !== number) {
      list.replaceChildren();
      delete list.dataset.vertex;
      make('dt', list, number < facts.vertices ? `vertex ${number} is not among those that are shown` : `there is no vertex ${number}`);
      return;
    }
    const surface = data.surfaces.length - 1;
    tell(surface, low);
    const {x, y} = view.place(surface, low);
    Object.assign(list.dataset, {x, y});
  }

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
    view = new VIEW.View(byId('view'), data);
  } catch (error) {
    message.textContent = `No view: ${error.message}. It takes a browser of 2023 or later, with WebGL. The figures are beside.`;
    document.body.dataset.ready = 'without a view';
    return;
  }
  addControls();
  view.resize();
  view.showAll();
  paint();
  update();
  listen();
  message.textContent = data.face.length === 0 ? 'No face is left to show.' : '';
  follow();
  await view.draw();
  document.body.dataset.ready = Math.round(performance.now());
})();
