// SPDX-License-Identifier: Apache-2.0
// The page around the view: what stands in the file, colours and their legend, the vertex that is picked, and the figures.
'use strict';

(async function () {
  const byId = id => document.getElementById(id);
  const facts = JSON.parse(byId('facts').textContent), report = JSON.parse(byId('report').textContent);

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
  const STATE_COLOURS = {reached: 0x6aaed6, collision: 0xf28e2b, limited: 0xd7191c, outside_field: 0xe377c2,
                         unused: 0x999999, mitred: 0x7b3294, cut: 0xb48ad0};
  const UNKNOWN = 0xb0b4b9;
  const SHARE_RAMP = [[0, 0xa50f15], [0.5, 0xf28e2b], [0.999, 0xffe9a8], [1, 0x6aaed6], [2, 0x7b3294]];
  const ERROR_RAMP = [[0, 0x6aaed6], [0.25, 0xffe9a8], [0.6, 0xf28e2b], [1, 0xa50f15]];

  function make(tag, parent, text, attributes) {
    const element = document.createElement(tag);
    if (text !== undefined) element.textContent = text;
    for (const [name, value] of Object.entries(attributes || {})) element.setAttribute(name, value);
    if (parent) parent.append(element);
    return element;
  }
  const inWords = count => Number(count).toLocaleString('en');
  const inDigits = number => Number.isFinite(number) ? String(Number(number.toPrecision(7))) : '–';
  const css = colour => '#' + colour.toString(16).padStart(6, '0');

  function onRamp(ramp, value) {
    if (!(value === value)) return UNKNOWN;
    if (value <= ramp[0][0]) return ramp[0][1];
    for (let i = 1; i < ramp.length; ++i) {
      const [from, low] = ramp[i - 1], [to, high] = ramp[i];
      if (value > to) continue;
      const t = (value - from) / (to - from);
      return [16, 8, 0].reduce((all, shift) => {
        const a = low >> shift & 255, b = high >> shift & 255;
        return all | Math.round(a + t * (b - a)) << shift;
      }, 0);
    }
    return ramp[ramp.length - 1][1];
  }
  // Around the circle of colours, by the golden angle, so that neighbours differ.
  function groupColour(group) {
    const hue = group * 137.508 % 360, light = [0.6, 0.45, 0.75][group % 3];
    return new THREE.Color().setHSL(hue / 360, 0.55, light).getHex();
  }

  async function unpack() {
    const element = byId('arrays'), binary = atob(element.textContent);
    element.remove();
    const bytes = Uint8Array.from(binary, c => c.charCodeAt(0));
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
      };
    });
    return {
      curves: facts.curves, sizeOfElement: facts.curves ? 2 : 3, vertex: arrays.vertex, corners: arrays.corners,
      face: arrays.face, edges: arrays.edges, group: arrays.group || null, source: {positions: arrays['source.positions']},
      surfaces,
    };
  }

  // Figures, which need no view.

  // Bars whose heights are logarithms, so that a few vertices beside a million can be seen.
  function bars(parent, title, entries, marks) {
    const most = Math.max(...entries.map(each => each.count), 1), width = 340, height = 90, each = width / entries.length;
    const label = `${title}: ` + entries.filter(e => e.count > 0).map(e => `${e.label}: ${inWords(e.count)}`).join(', ');
    make('h3', parent, title);
    const NS = 'http://www.w3.org/2000/svg';
    const draw = (tag, attributes, to) => {
      const element = document.createElementNS(NS, tag);
      for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
      to.append(element);
      return element;
    };
    const svg = document.createElementNS(NS, 'svg');
    parent.append(svg);
    for (const [name, value] of Object.entries({viewBox: `0 0 ${width} ${height + 16}`, role: 'img', 'aria-label': label}))
      svg.setAttribute(name, value);
    entries.forEach(({label: text, count, colour}, i) => {
      const high = count === 0 ? 0 : Math.max(2, height * Math.log10(1 + count) / Math.log10(1 + most));
      const bar = draw('rect', {x: i * each + 0.5, y: height - high, width: each - 1, height: high, fill: colour}, svg);
      draw('title', {}, bar).textContent = `${text}: ${inWords(count)}`;
    });
    draw('line', {x1: 0, x2: width, y1: height, y2: height}, svg);
    for (const [at, text, anchor] of marks)
      draw('text', {x: at * each, y: height + 12, 'text-anchor': anchor || 'middle'}, svg).textContent = text;
    make('p', parent, `most in one bar: ${inWords(most)}; heights are logarithms`);
  }

  function shareBars(surface) {
    const {below, at, above, step_above: step} = surface.histogram, entries = [];
    below.forEach((count, i) => entries.push({
      label: `${Math.round(100 * i / below.length)} to ${Math.round(100 * (i + 1) / below.length)} %`, count,
      colour: css(onRamp(SHARE_RAMP, (i + 0.5) / below.length)),
    }));
    entries.push({label: 'at the distance', count: at, colour: css(STATE_COLOURS.reached)});
    const last = above.reduce((end, count, i) => count > 0 ? i + 1 : end, 0);
    above.slice(0, last).forEach((count, i) => entries.push({
      label: `${100 * (1 + step * i)} % ${i + 1 === above.length ? 'and farther' : `to ${100 * (1 + step * (i + 1))} %`}`,
      count, colour: css(onRamp(SHARE_RAMP, 1 + step * (i + 0.5))),
    }));
    const marks = [[0, '0', 'start'], [below.length / 2, '50 %'], [below.length + 0.5, '100 %', last ? 'middle' : 'end']];
    if (last > 3) marks.push([below.length + 1 + last, `${100 * (1 + step * last)} %`, 'end']);
    return [entries, marks];
  }

  function showHistograms() {
    const parent = byId('histograms');
    // Of layers, the first and the outermost are measured.
    const shown = facts.layers ? [...new Set([0, facts.surfaces.length - 1])] : facts.surfaces.map((_, i) => i);
    for (const i of shown) {
      const surface = facts.surfaces[i], [entries, marks] = shareBars(surface);
      bars(parent, `${surface.name}: share of its distance that each ${facts.curves ? 'point' : 'vertex'} has`, entries, marks);
    }
    if (!facts.quality) return;
    const {invalid, counts} = facts.quality;
    bars(parent, 'cells by scaled Jacobian', [
      {label: '0 or below', count: invalid, colour: '#a50f15'},
      ...counts.map((count, i) => ({label: `${(i / counts.length).toFixed(2)} to ${((i + 1) / counts.length).toFixed(2)}`,
                                    count, colour: css(onRamp(ERROR_RAMP, 1 - (i + 0.5) / counts.length))})),
    ], [[1, '0'], [1 + counts.length / 2, '0.5'], [1 + counts.length, '1', 'end']]);
  }

  const inCell = value => value === null ? '–' : typeof value === 'number' && !Number.isInteger(value) ? inDigits(value) : String(value);
  // A table of what is named, and behind it a part that can be opened for each of what has parts.
  function addRows(parent, values) {
    const table = make('table', parent), isPlain = value => value === null || typeof value !== 'object';
    for (const [key, value] of Object.entries(values)) {
      const isList = Array.isArray(value) && value.every(isPlain);
      if (!isPlain(value) && !isList) continue;
      const row = make('tr', table);
      make('td', row, key.replaceAll('_', ' '));
      make('td', row, isList ? value.map(inCell).join(', ') : inCell(value));
    }
    const open = ['vertices_by_state', 'achieved', 'faces'];
    for (const [key, value] of Object.entries(values)) {
      if (isPlain(value) || (Array.isArray(value) && value.every(isPlain))) continue;
      const part = make('details', parent);
      if (open.includes(key)) part.open = true;
      make('summary', part, key.replaceAll('_', ' '));
      addRows(part, value);
    }
  }

  function showFigures() {
    byId('command').textContent = facts.command;
    for (const remark of facts.remarks) make('li', byId('remarks'), remark);
    const {elements, of} = facts.shown, what = facts.curves ? 'segments' : 'triangles';
    byId('shown').textContent = elements === of ? `${inWords(of)} ${what}, ${inWords(facts.vertices)} vertices, all shown.` :
        `Shown: ${inWords(elements)} of ${inWords(of)} ${what}. Vertices near each other are drawn as one of them, the one ` +
        'that is farthest from what was asked; its number and distances are its own. All figures are of all vertices.';
    showHistograms();
    if (report) addRows(byId('figures'), report);
    else byId('figures').remove();
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
      legend: to => ramp(to, SHARE_RAMP, 2, ['0', '50 %', '100 %', '150 %', '200 %']),
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
    axis.addEventListener('change', () => { looks.cutAxis = Number(axis.value); update(); });
    addRange('at', {id: 'cutAt', min: 0, max: 1, step: 0.005, value: looks.cutAt}, value => { looks.cutAt = value; });
    if (!facts.curves) addBox('edges', false, checked => { looks.edges = checked; });
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
      if (on && on.error) row('its error', `${inDigits(100 * on.error[element])} % of the distance`);
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
  showFigures();
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
