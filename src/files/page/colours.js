// SPDX-License-Identifier: Apache-2.0
// What surfaces can be coloured by, with the legend of each.
'use strict';

const COLOURS = (function () {
  const {make, inWords, inDigits, css, onRamp, lengthIn, STATE_COLOURS, UNKNOWN, SHARE_RAMP, ERROR_RAMP, LENGTH_RAMP} = FIGURES;
  const RAMP_PIXELS = 260, MOST_ENTRIES = 12;  // more would cover the view; all are in the list of groups

  // Around the circle of colours, by the golden angle, so that neighbours differ.
  function groupColour(group) {
    const hue = group * 137.508 % 360, light = [0.6, 0.45, 0.75][group % 3];
    return new THREE.Color().setHSL(hue / 360, 0.55, light).getHex();
  }

  // The greatest of the numbers but for the last fiftieth of them, so that a few do not hide all others. NaNs do not count.
  function almostMost(lists) {
    return lists.reduce((most, list) => {
      const sorted = Float32Array.from((list || []).filter(each => each === each)).sort();
      return sorted.length > 0 ? Math.max(most, sorted[Math.floor(0.98 * (sorted.length - 1))]) : most;
    }, 0);
  }

  // The least and the greatest distance that is asked for.
  function targetsOf(data) {
    let [least, most] = [Infinity, 0];
    for (const surface of data.surfaces)
      for (let v = 0; surface.achieved && v < surface.achieved.length; ++v) {
        const target = Math.abs(surface.target(v));
        if (target > 0) [least, most] = [Math.min(least, target), Math.max(most, target)];
      }
    return most > 0 ? [least, most] : null;
  }

  const noUnit = facts => facts.unit ? '' : ' (the file states no unit)';

  // How long so many percent of the distance are.
  function percentLine(to, facts, data, percent) {
    const targets = targetsOf(data);
    if (!targets) return;
    const [least, most] = targets.map(each => Number((each * percent / 100).toPrecision(4)));
    make('div', to, `${percent} % is ${least === most ? '' : `${inDigits(least)} to `}${lengthIn(facts, most)}${noUnit(facts)}`);
  }

  function ramp(to, colours, end, marks) {
    const bar = make('canvas', to, undefined, {class: 'ramp', width: RAMP_PIXELS, height: 1});
    const context = bar.getContext('2d');
    for (let x = 0; x < RAMP_PIXELS; ++x) {
      context.fillStyle = css(onRamp(colours, end * x / (RAMP_PIXELS - 1)));
      context.fillRect(x, 0, 1, 1);
    }
    const row = make('div', to, undefined, {class: 'marks'});
    marks.forEach((text, i) => { make('span', row, text).style.left = `${100 * i / (marks.length - 1)}%`; });
  }

  function entries(to, list) {
    const box = make('div', to, undefined, {class: 'entries'});
    for (const [colour, text] of list.slice(0, MOST_ENTRIES)) {
      const entry = make('span', box);
      make('span', entry, '', {class: 'swatch'}).style.background = css(colour);
      entry.append(text);
    }
    if (list.length > MOST_ENTRIES) make('span', box, `and ${list.length - MOST_ENTRIES} more`);
  }

  function addStates(to, facts) {
    const counts = facts.states.map((_, s) => facts.surfaces.reduce((sum, each) => sum + (each.states ? each.states[s] : 0), 0));
    // All of the layers have one state.
    const share = facts.layers ? facts.surfaces.length : 1;
    entries(to, facts.states.map((name, s) => [STATE_COLOURS[name], `${name} ${inWords(counts[s] / share)}`, counts[s]]).filter(e => e[2] > 0));
  }

  // Each way that this page can colour its surfaces by: what it is called, the colours of a surface, and the legend.
  function modes(facts, data) {
    const some = what => data.surfaces.some(each => each[what]), rounded = number => inDigits(Number(number.toPrecision(2)));
    const all = {};
    if (some('share'))
      all.share = {
        label: 'share of the distance',
        colours: ({share}) => (element, v) => share ? onRamp(SHARE_RAMP, share[v]) : UNKNOWN,
        legend: to => {
          ramp(to, SHARE_RAMP, 2, ['0', '50 %', '100 %', '', '200 %']);
          percentLine(to, facts, data, 100);
        },
      };
    if (some('achieved')) {
      const scale = almostMost(data.surfaces.map(each => each.achieved)) || 1;
      all.length = {
        label: facts.unit ? `distance in ${facts.unit}` : 'distance',
        colours: ({achieved}) => (element, v) => achieved ? onRamp(LENGTH_RAMP, achieved[v] / scale) : UNKNOWN,
        legend: to => {
          ramp(to, LENGTH_RAMP, 1, ['0', rounded(scale / 2), lengthIn(facts, Number(scale.toPrecision(4)))]);
          if (!facts.unit) make('div', to, noUnit(facts));
        },
      };
    }
    if (some('state'))
      all.state = {
        label: 'state',
        colours: ({state}) => (element, v) => state ? STATE_COLOURS[facts.states[state[v]]] : UNKNOWN,
        legend: to => addStates(to, facts),
      };
    if (some('error')) {
      const scale = Math.max(almostMost(data.surfaces.map(each => each.error)), 0.01);  // less than one percent is as good as none
      all.error = {
        label: 'error of faces', title: 'error of faces, in percent of the distance',
        colours: ({error}) => element => error ? onRamp(ERROR_RAMP, error[element] / scale) : UNKNOWN,
        legend: to => {
          ramp(to, ERROR_RAMP, 1, ['0', `${rounded(50 * scale)} %`, `${rounded(100 * scale)} % or more`]);
          percentLine(to, facts, data, 1);
          make('div', to, 'grey: not known');
        },
      };
    }
    if (data.source.mesh.group)
      all.group = {
        label: 'group',
        colours: ({mesh}) => element => mesh.group ? groupColour(mesh.group[element]) : UNKNOWN,
        legend: to => entries(to, facts.groups.map((name, i) => [groupColour(i), name])),
      };
    if (!all.share) all.plain = {label: 'one colour', colours: () => () => UNKNOWN, legend: () => {}};
    return all;
  }

  return {modes, groupColour};
})();
