// SPDX-License-Identifier: Apache-2.0
// The figures of a run: histograms and tables, which need no view. And what the page is made of everywhere: elements, numbers in
// words, colours.
'use strict';

const FIGURES = (function () {
  const byId = id => document.getElementById(id);
  const STATE_COLOURS = {reached: 0x6aaed6, collision: 0xf28e2b, limited: 0xd7191c, outside_field: 0xe377c2,
                         unused: 0x999999, mitered: 0x7b3294, cut: 0xb48ad0};
  const UNKNOWN = 0xb0b4b9;
  const SHARE_RAMP = [[0, 0xa50f15], [0.5, 0xf28e2b], [0.999, 0xffe9a8], [1, 0x6aaed6], [2, 0x7b3294]];
  const ERROR_RAMP = [[0, 0x6aaed6], [0.25, 0xffe9a8], [0.6, 0xf28e2b], [1, 0xa50f15]];
  const LENGTH_RAMP = [[0, 0x440154], [0.25, 0x3b528b], [0.5, 0x21918c], [0.75, 0x5ec962], [1, 0xfde725]];

  function make(tag, parent, text, attributes) {
    const element = document.createElement(tag);
    if (text !== undefined) element.textContent = text;
    for (const [name, value] of Object.entries(attributes || {})) element.setAttribute(name, value);
    if (parent) parent.append(element);
    return element;
  }
  const inWords = count => Number(count).toLocaleString('en');
  const inDigits = number => Number.isFinite(number) ? String(Number(number.toPrecision(7))) : '–';
  // A length with its unit, as far as the file states one.
  const lengthIn = (facts, length) => inDigits(length) + (facts.unit ? ` ${facts.unit}` : '');
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

  // Bars on a logarithmic scale, so that a few of something can be seen next to a million.
  function bars(parent, title, of, entries, marks) {
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
    make('p', parent, `log scale; tallest bar ${inWords(most)} ${of}`);
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
      label: `${100 * (1 + step * i)} % ${i + 1 === above.length ? 'or more' : `to ${100 * (1 + step * (i + 1))} %`}`,
      count, colour: css(onRamp(SHARE_RAMP, 1 + step * (i + 0.5))),
    }));
    const marks = [[0, '0', 'start'], [below.length / 2, '50 %'], [below.length + 0.5, '100 %', last ? 'middle' : 'end']];
    if (last > 3) marks.push([below.length + 1 + last, `${100 * (1 + step * last)} %`, 'end']);
    return [entries, marks];
  }

  function showHistograms(facts) {
    const parent = byId('histograms'), measured = facts.surfaces.some(each => each.histogram);
    if (!measured) return parent.remove();
    // Of layers, the first and the outermost are measured.
    const shown = facts.layers ? [...new Set([0, facts.surfaces.length - 1])] : facts.surfaces.map((_, i) => i);
    for (const i of shown) {
      const surface = facts.surfaces[i], [entries, marks] = shareBars(surface);
      const of = facts.curves ? 'points' : 'vertices';
      bars(parent, `${surface.name}: ${of} by their share of the distance`, of, entries, marks);
    }
    if (!facts.quality) return;
    const {invalid, counts} = facts.quality;
    bars(parent, 'cells by scaled Jacobian', 'cells', [
      {label: '0 or below', count: invalid, colour: '#a50f15'},
      ...counts.map((count, i) => ({label: `${(i / counts.length).toFixed(2)} to ${((i + 1) / counts.length).toFixed(2)}`,
                                    count, colour: css(onRamp(ERROR_RAMP, 1 - (i + 0.5) / counts.length))})),
    ], [[1, '0'], [1 + counts.length / 2, '0.5'], [1 + counts.length, '1', 'end']]);
  }

  const inCell = value => value === null ? '–' : typeof value === 'number' && !Number.isInteger(value) ? inDigits(value) : String(value);
  // A table of the values, then a part that can be opened for each value that has parts.
  function addRows(parent, values) {
    const table = make('table', parent), isPlain = value => value === null || typeof value !== 'object';
    const isList = value => Array.isArray(value) && value.every(each => isPlain(each) || each.text);
    for (const [key, value] of Object.entries(values)) {
      if (!isPlain(value) && !isList(value)) continue;
      const row = make('tr', table);
      make('td', row, key.replaceAll('_', ' '));
      make('td', row, isList(value) ? value.map(each => each?.text ?? inCell(each)).join(', ') : inCell(value));
    }
    const open = ['vertices_by_state', 'achieved', 'faces'];
    for (const [key, value] of Object.entries(values)) {
      if (isPlain(value) || isList(value)) continue;
      const part = make('details', parent);
      if (open.includes(key)) part.open = true;
      make('summary', part, key.replaceAll('_', ' '));
      addRows(part, value);
    }
  }

  function shownOf(facts, {shown, vertices}) {
    const {elements, of} = shown, what = facts.curves ? 'segments' : 'triangles';
    return elements === of ? `${inWords(of)} ${what}, ${inWords(vertices)} vertices, all shown.` :
        `Shown: ${inWords(elements)} of ${inWords(of)} ${what}. Of several vertices close together, the one that misses the distance ` +
        'most is drawn, with its own number and distances. Figures are of all vertices.';
  }

  function show(facts, report) {
    byId('command').textContent = facts.command;
    for (const remark of facts.remarks) make('li', byId('remarks'), remark);
    const meshes = [facts, ...facts.surfaces].filter(each => each.shown);
    meshes.forEach((each, i) => make('p', byId('shown'), (meshes.length > 1 ? `${i ? each.name : facts.title}: ` : '') + shownOf(facts, each)));
    showHistograms(facts);
    if (report) addRows(byId('figures'), report);
    else byId('figures').remove();
  }

  return {make, inWords, inDigits, lengthIn, css, onRamp, show, STATE_COLOURS, UNKNOWN, SHARE_RAMP, ERROR_RAMP, LENGTH_RAMP};
})();
