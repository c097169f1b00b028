// SPDX-License-Identifier: Apache-2.0
// Where a surface misses its distance most, place after place; which groups are shown; and the picture to save. What a page
// lets one do with the view, other than turning it.
'use strict';

const PLACES = (function () {
  const byId = id => document.getElementById(id);
  const {make, inWords, inDigits, css} = FIGURES;
  // Places are this share of the diagonal apart. What misses the distance by less is as good as there.
  const APART = 0.05, LEAST = 0.01, SEEN_SIZE = 0.25, FOLDED = 50, MOST_LISTED = 2000;
  const SLANTS = [0, 35, 60, 78, 87].map(degrees => degrees * Math.PI / 180), TURNS = 8;

  // Calls visit(surface, off, vertices, element) for all that is shown: by what share of its distance a vertex, or a face if
  // there is an element, misses it. A vertex with a miter is meant to be off.
  function visitMisses(facts, data, view, isSurfaceShown, visit) {
    const isMiter = facts.states.map(name => ['mitered', 'cut', 'unused'].includes(name));
    const isShown = data.source.mesh.group && view.shown ? view : null;
    data.surfaces.forEach((surface, i) => {
      if (!isSurfaceShown(i)) return;
      const {share, state, error, mesh} = surface, size = data.sizeOfElement;
      for (let v = 0; share && v < share.length; ++v)
        if (share[v] === share[v] && !(state && isMiter[state[v]]) && !(isShown && !view.isVertexShown[v]))
          visit(i, Math.abs(1 - share[v]), [v]);
      for (let e = 0; error && e < error.length; ++e)
        if (error[e] === error[e] && !(isShown && !view.shown[mesh.group[e]]))
          visit(i, error[e], mesh.corners.subarray(size * e, size * (e + 1)), e);
    });
  }

  // The worst place that is far enough from those visited, or null.
  function worst(facts, data, view, isSurfaceShown, visited) {
    const apart = APART * view.diagonal();
    let found = {off: LEAST};
    visitMisses(facts, data, view, isSurfaceShown, (surface, off, vertices, element) => {
      if (!(off > found.off)) return;
      const place = new THREE.Vector3();
      for (const v of vertices) place.addScaledVector(view.position(surface, v), 1 / vertices.length);
      if (visited.every(each => each.distanceTo(place) >= apart)) found = {surface, off, vertex: vertices[0], element, place};
    });
    return found.place ? found : null;
  }

  // A face that has the vertex: what is there is looked at from outside.
  function faceAt(data, {surface, vertex, element}) {
    const {corners} = data.surfaces[surface].mesh;
    return element === undefined ? Math.floor(corners.indexOf(vertex) / data.sizeOfElement) : element;
  }

  // From where a place is seen: from straight above, or where something is in front of it, at the least slant that is free.
  function wayOfSeeing(view, place, normal) {
    const far = view.awayFor(SEEN_SIZE * view.diagonal());
    const across = new THREE.Vector3(...(Math.abs(normal.x) < 0.6 ? [1, 0, 0] : [0, 1, 0])).cross(normal).normalize();
    const other = normal.clone().cross(across);
    let best = {direction: normal, away: 0};
    for (const slant of SLANTS)
      for (let turn = 0; turn < (slant > 0 ? TURNS : 1); ++turn) {
        const angle = 2 * Math.PI * turn / TURNS;
        const direction = normal.clone().multiplyScalar(Math.cos(slant)).addScaledVector(across, Math.sin(slant) * Math.cos(angle))
            .addScaledVector(other, Math.sin(slant) * Math.sin(angle));
        const away = view.sightFrom(place, direction, far);
        if (away > best.away) best = {direction, away: away < far ? 0.9 * away : far};
        if (away >= far) return best;
      }
    return best;
  }

  // Adds the button that goes from one of the worst places to the next. tell(surface, vertex, element) says what is there.
  function addWorst(facts, data, view, isSurfaceShown, tell) {
    if (!data.surfaces.some(each => each.share || each.error)) return;
    const button = make('button', byId('tools'), 'Next worst place', {
      id: 'worst', type: 'button',
      title: 'Go to the vertex or face that misses its distance by the largest share, then to the next that is at least 5 % of the diagonal away'});
    let visited = [];
    button.addEventListener('click', () => {
      const found = worst(facts, data, view, isSurfaceShown, visited), note = byId('message');
      if (!found) {
        note.textContent = visited.length === 0 ? 'Everything shown is within 1 % of the distance.' :
            `No other place misses the distance by more than 1 % of it (${visited.length} visited). The next click starts again.`;
        visited = [];
        return;
      }
      visited.push(found.place);
      const {surface, vertex, element, off} = found, {mesh} = data.surfaces[surface];
      const inPercent = share => `${inDigits(Number((100 * share).toPrecision(3)))} %`;
      note.textContent = `Worst place ${visited.length}: ` + (element === undefined ?
          `vertex ${mesh.vertex[vertex]} is at ${inPercent(data.surfaces[surface].share[vertex])} of its distance.` :
          `${facts.curves ? 'a segment of curve' : 'face'} ${mesh.face[element]} is off by ${inPercent(off)} of the distance.`);
      const {direction, away} = data.curves ? {direction: view.direction, away: view.awayFor(SEEN_SIZE * view.diagonal())} :
          wayOfSeeing(view, found.place, view.normal(surface, faceAt(data, found)));
      view.flyTo(found.place, direction, away, matchMedia('(prefers-reduced-motion: reduce)').matches);
      tell(surface, vertex, element);
    });
  }

  // A list of groups with boxes to hide them.
  function addGroups(facts, data, view, colourOf, update) {
    const section = byId('groups'), {group} = data.source.mesh;
    if (!group || facts.groups.length < 2) return section.remove();
    const shown = new Uint8Array(facts.groups.length).fill(1), boxes = [];
    const show = () => {
      view.showGroups(shown);
      update();
    };
    const row = make('p', section);
    for (const [text, value] of [['Show all', 1], ['Hide all', 0]])
      make('button', row, text, {type: 'button'}).addEventListener('click', () => {
        shown.fill(value);
        for (const box of boxes) box.checked = value === 1;
        show();
      });
    const folded = facts.groups.length > FOLDED, parent = folded ? make('details', section) : section;
    if (folded) make('summary', parent, `${inWords(facts.groups.length)} groups`);
    const list = make('div', parent, undefined, {id: 'grouplist'});
    facts.groups.slice(0, MOST_LISTED).forEach((name, i) => {
      const label = make('label', list), box = make('input', label, undefined, {type: 'checkbox'});
      make('span', label, '', {class: 'swatch'}).style.background = css(colourOf(i));
      label.append(name);
      box.checked = true;
      box.addEventListener('change', () => {
        shown[i] = box.checked ? 1 : 0;
        show();
      });
      boxes.push(box);
    });
    if (facts.groups.length > MOST_LISTED) make('p', parent, `${inWords(facts.groups.length - MOST_LISTED)} more are not listed.`);
  }

  // Draws what an element of the page shows: its ramps, swatches and texts.
  function drawElement(context, element, from) {
    const place = box => [box.left - from.left, box.top - from.top, box.width, box.height];
    const style = getComputedStyle(element);
    if (['legend', 'swatch'].includes(element.id || element.className)) {
      context.fillStyle = style.backgroundColor;
      context.fillRect(...place(element.getBoundingClientRect()));
    }
    if (element.tagName === 'CANVAS') context.drawImage(element, ...place(element.getBoundingClientRect()));
    for (const child of element.childNodes) {
      if (child.nodeType === Node.ELEMENT_NODE) drawElement(context, child, from);
      if (child.nodeType !== Node.TEXT_NODE) continue;
      const range = document.createRange();
      range.selectNodeContents(child);
      const [x, y, , height] = place(range.getBoundingClientRect());
      context.font = `${style.fontSize} ${style.fontFamily}`;
      context.fillStyle = style.color;
      context.textBaseline = 'middle';
      context.fillText(child.textContent, x, y + height / 2);
    }
  }

  // Adds the button that saves the view, and its legend, as a PNG.
  function addPicture(facts, view) {
    const button = make('button', byId('tools'), 'Save picture', {id: 'picture', type: 'button'});
    button.addEventListener('click', () => {
      const picture = view.picture(), context = picture.getContext('2d'), stage = byId('view').getBoundingClientRect();
      context.scale(picture.width / stage.width, picture.height / stage.height);
      if (byId('legend').firstChild) drawElement(context, byId('legend'), stage);
      picture.toBlob(bytes => {
        const link = make('a', null, undefined, {download: `${facts.title}.png`, href: URL.createObjectURL(bytes)});
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 1000);
      }, 'image/png');
    });
  }

  return {addWorst, addGroups, addPicture};
})();
