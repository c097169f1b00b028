// SPDX-License-Identifier: Apache-2.0
// What is drawn: the source and the surfaces, by three.js. Colours and picking know of vertices; nothing here knows of the
// page around the canvas. What is drawn has in userData whose vertices its points are, so that they can be moved, and whether
// a point is shown where groups are hidden.
'use strict';

const VIEW = (function () {
  const FIELD_OF_VIEW = 35, TURN = Math.PI / 36, NEARER = 0.9;
  const MARK_PIXELS = 5, PICKED_PIXELS = 11, LINE_PIXELS = 6, FLIGHT_MS = 400;
  // Where the camera is at first if x, y or z is up.
  const DIRECTIONS = [[0.6, 0.75, -1], [0.75, 0.6, 1], [0.75, -1, 0.6]];

  // Each corner of an element has a point of its own: faces can have a colour then, and need no normals.
  function spread(values, width, corners) {
    const out = new values.constructor(corners.length * width);
    for (let i = 0; i < corners.length; ++i)
      for (let k = 0; k < width; ++k) out[width * i + k] = values[width * corners[i] + k];
    return out;
  }

  function material(curves, options) {
    if (curves) return new THREE.LineBasicMaterial(options);
    const made = new THREE.MeshPhongMaterial(Object.assign({
      side: THREE.DoubleSide, flatShading: true, shininess: 0, specular: 0x000000,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }, options));
    // Inner sides are darker, so that what is cut open can be told from what is in front.
    made.onBeforeCompile = shader => {
      shader.fragmentShader = shader.fragmentShader.replace(
          '#include <color_fragment>', '#include <color_fragment>\n  if (!gl_FrontFacing) diffuseColor.rgb *= 0.5;');
    };
    return made;
  }

  class View {
    // up: 0 to 2, the axis that is up at first.
    constructor(canvas, data, up) {
      this.canvas = canvas;
      this.data = data;
      this.share = 1;  // of their ways that vertices are shown at
      this.opacity = 0.25;
      this.renderer = new THREE.WebGLRenderer({canvas: canvas, antialias: true});
      this.renderer.localClippingEnabled = true;
      this.scene = new THREE.Scene();
      this.camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.1, 10);
      this.plane = new THREE.Plane(new THREE.Vector3(1, 0, 0), 0);
      this.cutting = false;
      const light = new THREE.DirectionalLight(0xffffff, 0.55);
      light.position.set(0.4, 0.7, 1);
      this.camera.add(light);
      this.scene.add(this.camera, new THREE.AmbientLight(0xffffff, 0.5));
      this.box = new THREE.Box3();
      this.addObjects();
      this.setUp(up);
      canvas.addEventListener('keydown', event => this.onKey(event));
    }

    // The controls of three.js take the axis that is up when they are made.
    setUp(axis) {
      this.placeCamera(axis);
      if (this.controls) this.controls.dispose();
      this.controls = new THREE.OrbitControls(this.camera, this.canvas);
      this.controls.enableKeys = false;  // they would move the page's own focus about, and cannot turn
      this.controls.addEventListener('start', () => { this.flight = null; });
      this.controls.addEventListener('change', () => this.draw());
      this.showAll();
    }

    addObjects() {
      const {source, surfaces} = this.data;
      this.source = this.addSurface(-1, {color: 0x8a9099});
      this.surfaces = surfaces.map((_, i) => this.addSurface(i, {vertexColors: THREE.VertexColors}));
      for (const each of [source, ...surfaces]) this.box.union(new THREE.Box3().setFromArray(each.positions));
      this.edges = surfaces.map(() => null);
      this.marks = [];
      const material = new THREE.PointsMaterial(
          {color: 0xffd000, size: PICKED_PIXELS, sizeAttenuation: false, depthTest: false, transparent: true});
      this.mark = new THREE.Points(new THREE.BufferGeometry(), material);
      this.mark.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3), 3));
      this.mark.userData = {surface: -1, vertices: [0]};
      this.mark.visible = false;
      this.mark.renderOrder = 2;
      this.scene.add(this.mark);
    }

    of(surface) { return surface < 0 ? this.data.source : this.data.surfaces[surface]; }

    // All that is drawn and can be moved, cut or hidden.
    objects() { return [this.source, ...this.surfaces, ...this.edges.filter(each => each !== null), ...this.marks]; }

    addSurface(surface, options) {
      const {curves, sizeOfElement} = this.data, {positions, mesh} = this.of(surface), {corners, group} = mesh;
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(spread(positions, 3, corners), 3));
      if (options.vertexColors) {
        geometry.setAttribute('color', new THREE.BufferAttribute(new Uint8Array(3 * corners.length), 3, true));
      }
      const object = new (curves ? THREE.LineSegments : THREE.Mesh)(geometry, material(curves, options));
      object.userData = {surface, vertices: corners, isShown: group && (i => this.shown[group[Math.floor(i / sizeOfElement)]])};
      this.scene.add(object);
      return object;
    }

    // Shows vertices a share of their way from the source to where they are in the end: straight, as paths are not kept.
    setShare(share) {
      this.share = share;
      for (const object of [...this.objects(), this.mark]) if (object.userData.vertices) this.placePoints(object);
    }

    placePoints(object) {
      const {surface, vertices} = object.userData, out = object.geometry.attributes.position;
      for (let i = 0; i < vertices.length; ++i)
        for (let k = 0; k < 3; ++k) out.array[3 * i + k] = this.coordinate(surface, 3 * vertices[i] + k);
      out.needsUpdate = true;
      object.geometry.computeBoundingSphere();
    }

    coordinate(surface, at) {
      const {source} = this.data, {positions, mesh} = this.of(surface), from = source.positions[at], to = positions[at];
      return mesh !== source.mesh || this.share === 1 ? to : from + this.share * (to - from);
    }

    // shown: of each group whether it is drawn.
    showGroups(shown) {
      this.shown = shown;
      const {mesh} = this.data.source, size = this.data.sizeOfElement;
      this.isVertexShown = new Uint8Array(mesh.vertex.length);
      for (let i = 0; i < mesh.corners.length; ++i)
        if (shown[mesh.group[Math.floor(i / size)]]) this.isVertexShown[mesh.corners[i]] = 1;
      for (const object of this.objects()) this.hidePoints(object);
    }

    hidePoints({geometry, userData}) {
      if (!this.shown || !userData.isShown) return;
      const count = geometry.attributes.position.count;
      if (!geometry.index) geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(count), 1));
      let drawn = 0;
      for (let i = 0; i < count; ++i) if (userData.isShown(i)) geometry.index.array[drawn++] = i;
      geometry.index.needsUpdate = true;
      geometry.setDrawRange(0, drawn);
    }

    // colours(element, vertex) returns red, green and blue in one number.
    paint(index, colours) {
      const {sizeOfElement} = this.data, {corners} = this.data.surfaces[index].mesh;
      const attribute = this.surfaces[index].geometry.attributes.color, bytes = attribute.array;
      for (let i = 0; i < corners.length; ++i) {
        const colour = colours(Math.floor(i / sizeOfElement), corners[i]);
        bytes[3 * i] = colour >> 16;
        bytes[3 * i + 1] = colour >> 8 & 255;
        bytes[3 * i + 2] = colour & 255;
      }
      attribute.needsUpdate = true;
    }

    // 'hidden', 'see-through' or 'solid'.
    setLook(object, look) {
      object.visible = look !== 'hidden';
      object.material.transparent = look === 'see-through';
      object.material.opacity = look === 'see-through' ? this.opacity : 1;
      object.material.depthWrite = look !== 'see-through';
      object.material.needsUpdate = true;
    }

    showEdges(index, shown) {
      if (shown && !this.edges[index]) this.edges[index] = this.makeEdges(index);
      if (this.edges[index]) this.edges[index].visible = shown;
    }

    makeEdges(index) {
      const {corners, edges, group} = this.data.surfaces[index].mesh, vertices = [], elements = [];
      for (let e = 0; e < edges.length; ++e)
        for (let k = 0; k < 3; ++k) {
          if (!(edges[e] >> k & 1)) continue;
          vertices.push(corners[3 * e + k], corners[3 * e + (k + 1) % 3]);
          elements.push(e);
        }
      const material = new THREE.LineBasicMaterial({color: 0x000000, transparent: true, opacity: 0.35});
      const lines = new THREE.LineSegments(this.pointsAt(vertices), material);
      lines.userData = {surface: index, vertices, isShown: group && (i => this.shown[group[elements[i >> 1]]])};
      return this.added(lines);
    }

    pointsAt(vertices) {
      const geometry = new THREE.BufferGeometry();
      return geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * vertices.length), 3));
    }

    // What is drawn from now on, as all else is: moved, cut, and without groups that are hidden.
    added(object) {
      object.material.clippingPlanes = this.cutting ? [this.plane] : null;
      if (object.userData.vertices) this.placePoints(object);
      this.hidePoints(object);
      this.scene.add(object);
      return object;
    }

    // Points at vertices, in one colour each.
    addMarks(surface, vertices, colours) {
      const isShown = this.of(surface).mesh.group && (i => this.isVertexShown[vertices[i]]);
      return this.addPoints(this.pointsAt(vertices), colours, {surface, vertices, isShown});
    }

    // Points in the middles of faces, of which the page knows the groups.
    addFaultMarks(positions, colours, groups) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
      return this.addPoints(geometry, colours, {isShown: groups && (i => this.shown[groups[i]])});
    }

    addPoints(geometry, colours, userData) {
      geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3, true));
      const points = new THREE.Points(
          geometry, new THREE.PointsMaterial({vertexColors: THREE.VertexColors, size: MARK_PIXELS, sizeAttenuation: false}));
      points.renderOrder = 1;
      points.userData = userData;
      this.marks.push(this.added(points));
      return points;
    }

    // Cuts off a share of the box along an axis, from the side that was in front when the axis was chosen; axis < 0 shows all.
    cut(axis, share) {
      this.cutting = axis >= 0;
      if (this.cutting && axis !== this.cutAxis)
        this.cutSide = Math.sign(this.camera.position.getComponent(axis) - this.controls.target.getComponent(axis)) || 1;
      this.cutAxis = axis;
      if (this.cutting) {
        const low = this.box.min.getComponent(axis), high = this.box.max.getComponent(axis);
        this.plane.normal.set(0, 0, 0).setComponent(axis, -this.cutSide);
        this.plane.constant = this.cutSide > 0 ? high - share * (high - low) : -low - share * (high - low);
      }
      for (const object of this.objects()) object.material.clippingPlanes = this.cutting ? [this.plane] : null;
    }

    // Curves, and all that is flat, are seen from above.
    placeCamera(up) {
      const size = this.box.getSize(new THREE.Vector3());
      const flat = [0, 1, 2].find(k => size.getComponent(k) <= 1e-6 * size.length());
      this.direction = new THREE.Vector3(...DIRECTIONS[up]).normalize();
      this.camera.up.set(0, 0, 0).setComponent(up, 1);
      if (flat === undefined) return;
      this.direction.set(0, 0, 0).setComponent(flat, flat === 1 && up !== 1 ? -1 : 1);
      if (flat === up) this.camera.up.set(...[[0, 0, 1], [0, 0, -1], [0, 1, 0]][up]);
    }

    diagonal() { return this.box.getSize(new THREE.Vector3()).length(); }

    // How far away all corners of the box are in view.
    distanceToFit() {
      const {min, max} = this.box, half = Math.tan(FIELD_OF_VIEW / 2 * Math.PI / 180);
      const right = this.camera.up.clone().cross(this.direction).normalize(), up = this.direction.clone().cross(right);
      let distance = 0;
      for (let corner = 0; corner < 8; ++corner) {
        const at = new THREE.Vector3(corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z);
        at.sub(this.controls.target);
        const across = Math.max(Math.abs(at.dot(right)) / this.camera.aspect, Math.abs(at.dot(up)));
        distance = Math.max(distance, across / half + at.dot(this.direction));
      }
      return distance || 1;
    }

    showAll() {
      this.flight = null;
      this.box.getCenter(this.controls.target);
      const distance = 1.05 * this.distanceToFit();
      this.camera.position.copy(this.controls.target).addScaledVector(this.direction, distance);
      this.camera.near = distance / 200;
      this.camera.far = distance * 20;
      this.camera.updateProjectionMatrix();
      this.controls.update();
      this.draw();
    }

    // From how far away this size fills the view.
    awayFor(size) { return size / 2 / Math.tan(FIELD_OF_VIEW / 2 * Math.PI / 180); }

    // How far one sees from a place on a surface, at most `far`.
    sightFrom(place, direction, far) {
      const caster = new THREE.Raycaster(place.clone().addScaledVector(direction, 1e-3 * far), direction, 0, far);
      const hits = this.hits(caster, this.surfaces.filter(each => each.visible));
      return hits.length > 0 ? hits[0].distance : far;
    }

    hits(caster, objects) {
      return caster.intersectObjects(objects).filter(hit => !this.cutting || this.plane.distanceToPoint(hit.point) >= 0);
    }

    // Goes to a place and looks at it from a direction and so far away, or at once if `isQuick`.
    flyTo(place, direction, away, isQuick) {
      const target = this.controls.target.clone(), position = this.camera.position.clone();
      const end = place.clone().addScaledVector(direction, away), begin = performance.now(), flight = this.flight = {};
      const step = () => {
        if (this.flight !== flight) return;  // the user turns the view, or goes elsewhere
        const share = isQuick ? 1 : Math.min(1, (performance.now() - begin) / FLIGHT_MS), eased = share * share * (3 - 2 * share);
        this.controls.target.lerpVectors(target, place, eased);
        this.camera.position.lerpVectors(position, end, eased);
        this.controls.update();
        this.draw();
        if (share < 1) requestAnimationFrame(step);
      };
      step();
    }

    // Outward at an element of a surface.
    normal(surface, element) {
      const {corners} = this.of(surface).mesh, [a, b, c] = [0, 1, 2].map(k => this.position(surface, corners[3 * element + k]));
      return b.sub(a).cross(c.sub(a)).normalize();
    }

    onKey(event) {
      const turns = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
      const nearer = {'+': NEARER, '=': NEARER, '-': 1 / NEARER};
      const offset = this.camera.position.clone().sub(this.controls.target);
      if (turns[event.key]) this.turn(offset, ...turns[event.key]);
      else if (nearer[event.key]) offset.multiplyScalar(nearer[event.key]);
      else if (event.key === 'Home') return this.showAll();
      else return;
      event.preventDefault();
      this.camera.position.copy(this.controls.target).add(offset);
      this.controls.update();
      this.draw();
    }

    turn(offset, right, down) {
      const toZenith = offset.angleTo(this.camera.up), angle = toZenith + down * TURN;
      offset.applyAxisAngle(this.camera.up, right * TURN);
      if (angle < 0.02 || angle > Math.PI - 0.02) return;
      const across = this.camera.up.clone().cross(offset).normalize();
      if (across.lengthSq() > 0) offset.applyAxisAngle(across, down * TURN);
    }

    resize() {
      const {clientWidth, clientHeight} = this.canvas.parentElement;
      if (clientWidth === 0 || clientHeight === 0) return;
      this.renderer.setPixelRatio(window.devicePixelRatio);
      this.renderer.setSize(clientWidth, clientHeight, false);
      this.camera.aspect = clientWidth / clientHeight;
      this.camera.updateProjectionMatrix();
      this.draw();
    }

    setBackground(colour) { this.renderer.setClearColor(new THREE.Color(colour)); }

    // Once a frame, however much has changed. Resolves when it is done.
    draw() {
      this.drawn = this.drawn || new Promise(done => requestAnimationFrame(() => {
        this.drawn = null;
        this.renderer.render(this.scene, this.camera);
        done();
      }));
      return this.drawn;
    }

    // The view as it is now, on a canvas that keeps it.
    picture() {
      this.renderer.render(this.scene, this.camera);
      const copy = document.createElement('canvas');
      [copy.width, copy.height] = [this.canvas.width, this.canvas.height];
      copy.getContext('2d').drawImage(this.canvas, 0, 0);
      return copy;
    }

    // What stands at a place of the canvas: the vertex nearest to the point that is seen there, or null.
    pick(x, y) {
      const {width, height} = this.canvas.getBoundingClientRect();  // clientHeight is rounded
      const caster = new THREE.Raycaster();
      this.camera.updateMatrixWorld();
      caster.setFromCamera(new THREE.Vector2(2 * x / width - 1, 1 - 2 * y / height), this.camera);
      const away = this.camera.position.distanceTo(this.controls.target);
      caster.linePrecision = 2 * LINE_PIXELS * away * Math.tan(FIELD_OF_VIEW / 2 * Math.PI / 180) / height;
      const seen = this.surfaces.filter(each => each.visible), solid = seen.filter(each => !each.material.transparent);
      if (this.source.visible && (!this.source.material.transparent || seen.length === 0)) solid.push(this.source);
      const hits = this.hits(caster, solid.length > 0 ? solid : seen);
      return hits.length > 0 ? this.vertexAt(hits[0]) : null;
    }

    vertexAt(hit) {
      const {sizeOfElement} = this.data, {surface} = hit.object.userData, {corners} = this.of(surface).mesh;
      // A face's corners stand one behind the other, whether or not others are hidden.
      const element = Math.floor((sizeOfElement === 3 ? hit.face.a : hit.index) / sizeOfElement);
      let best = null;
      for (let k = 0; k < sizeOfElement; ++k) {
        const vertex = corners[sizeOfElement * element + k];
        const distance = hit.point.distanceToSquared(this.position(surface, vertex));
        if (!best || distance < best.distance) best = {surface, vertex, element, distance};
      }
      return best;
    }

    // Where a vertex is shown: on the source if surface is below 0.
    position(surface, vertex) {
      return new THREE.Vector3(...[0, 1, 2].map(k => this.coordinate(surface, 3 * vertex + k)));
    }

    setMark(surface, vertex) {
      this.mark.visible = true;
      this.mark.userData = {surface, vertices: [vertex]};
      this.placePoints(this.mark);
      this.draw();
    }

    // From positions to the canvas, column by column.
    matrix() {
      this.camera.updateMatrixWorld();
      const {projectionMatrix, matrixWorldInverse} = this.camera;
      return new THREE.Matrix4().multiplyMatrices(projectionMatrix, matrixWorldInverse).elements;
    }

    // Where on the canvas a vertex is drawn.
    place(surface, vertex) {
      this.camera.updateMatrixWorld();
      const p = this.position(surface, vertex).project(this.camera);
      const {width, height} = this.canvas.getBoundingClientRect();
      return {x: (p.x + 1) / 2 * width, y: (1 - p.y) / 2 * height};
    }
  }

  return {View};
})();
