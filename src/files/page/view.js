// SPDX-License-Identifier: Apache-2.0
// What is drawn: the source and the surfaces, by three.js. Colours and picking know of vertices; nothing here knows of the
// page around the canvas.
'use strict';

const VIEW = (function () {
  const FIELD_OF_VIEW = 35, TURN = Math.PI / 36, NEARER = 0.9;
  const MARK_PIXELS = 5, PICKED_PIXELS = 11, LINE_PIXELS = 6;

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
    constructor(canvas, data) {
      this.canvas = canvas;
      this.data = data;
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
      this.placeCamera();
      this.controls = new THREE.OrbitControls(this.camera, canvas);
      this.controls.enableKeys = false;  // they would move the page's own focus about, and cannot turn
      this.controls.addEventListener('change', () => this.draw());
      canvas.addEventListener('keydown', event => this.onKey(event));
      this.showAll();
    }

    addObjects() {
      const {source, surfaces} = this.data;
      this.source = this.addSurface(source.positions, {color: 0x8a9099, transparent: true, opacity: 0.25, depthWrite: false});
      this.surfaces = surfaces.map(each => this.addSurface(each.positions, {vertexColors: THREE.VertexColors}));
      for (const each of [source, ...surfaces]) this.box.union(new THREE.Box3().setFromArray(each.positions));
      this.edges = surfaces.map(() => null);
      this.marks = [];
      const material = new THREE.PointsMaterial(
          {color: 0xffd000, size: PICKED_PIXELS, sizeAttenuation: false, depthTest: false, transparent: true});
      this.mark = new THREE.Points(new THREE.BufferGeometry(), material);
      this.mark.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3), 3));
      this.mark.frustumCulled = false;
      this.mark.visible = false;
      this.mark.renderOrder = 2;
      this.scene.add(this.mark);
    }

    addSurface(positions, options) {
      const {corners, curves} = this.data;
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(spread(positions, 3, corners), 3));
      if (options.vertexColors) {
        geometry.setAttribute('color', new THREE.BufferAttribute(new Uint8Array(3 * corners.length), 3, true));
      }
      const object = new (curves ? THREE.LineSegments : THREE.Mesh)(geometry, material(curves, options));
      this.scene.add(object);
      return object;
    }

    // colours(element, vertex) returns red, green and blue in one number.
    paint(index, colours) {
      const {corners, sizeOfElement} = this.data;
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
      object.material.opacity = look === 'see-through' ? 0.25 : 1;
      object.material.depthWrite = look !== 'see-through';
      object.material.needsUpdate = true;
    }

    showEdges(index, shown) {
      if (shown && !this.edges[index]) this.edges[index] = this.makeEdges(index);
      if (this.edges[index]) this.edges[index].visible = shown;
    }

    makeEdges(index) {
      const {corners, edges} = this.data, positions = this.data.surfaces[index].positions;
      const points = [];
      for (let e = 0; e < edges.length; ++e)
        for (let k = 0; k < 3; ++k) {
          if (!(edges[e] >> k & 1)) continue;
          for (const v of [corners[3 * e + k], corners[3 * e + (k + 1) % 3]])
            points.push(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
        }
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points), 3));
      const lines = new THREE.LineSegments(
          geometry, new THREE.LineBasicMaterial({color: 0x000000, transparent: true, opacity: 0.35}));
      lines.material.clippingPlanes = this.cutting ? [this.plane] : null;
      this.scene.add(lines);
      return lines;
    }

    // Points at vertices, in one colour each.
    addMarks(index, vertices, colours) {
      return this.addPoints(spread(this.data.surfaces[index].positions, 3, vertices), colours);
    }

    addPoints(positions, colours) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
      geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3, true));
      const points = new THREE.Points(
          geometry, new THREE.PointsMaterial({vertexColors: THREE.VertexColors, size: MARK_PIXELS, sizeAttenuation: false}));
      points.renderOrder = 1;
      this.scene.add(points);
      this.marks.push(points);
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
      const lines = this.edges.filter(each => each !== null);
      for (const object of [this.source, ...this.surfaces, ...lines, ...this.marks])
        object.material.clippingPlanes = this.cutting ? [this.plane] : null;
    }

    // Curves, and all that is flat, are seen from above.
    placeCamera() {
      const size = this.box.getSize(new THREE.Vector3());
      const flat = [0, 1, 2].find(k => size.getComponent(k) <= 1e-6 * size.length());
      this.direction = new THREE.Vector3(0.75, -1, 0.6).normalize();
      this.camera.up.set(0, 0, 1);
      if (flat === undefined) return;
      this.direction.set(0, 0, 0).setComponent(flat, flat === 1 ? -1 : 1);
      if (flat === 2) this.camera.up.set(0, 1, 0);
    }

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
      this.box.getCenter(this.controls.target);
      const distance = 1.05 * this.distanceToFit();
      this.camera.position.copy(this.controls.target).addScaledVector(this.direction, distance);
      this.camera.near = distance / 200;
      this.camera.far = distance * 20;
      this.camera.updateProjectionMatrix();
      this.controls.update();
      this.draw();
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
      const hits = caster.intersectObjects(solid.length > 0 ? solid : seen)
          .filter(hit => !this.cutting || this.plane.distanceToPoint(hit.point) >= 0);
      return hits.length > 0 ? this.vertexAt(hits[0]) : null;
    }

    vertexAt(hit) {
      const {corners, sizeOfElement} = this.data;
      const surface = this.surfaces.indexOf(hit.object);
      const element = sizeOfElement === 3 ? hit.faceIndex : Math.floor(hit.index / 2);
      let best = null;
      for (let k = 0; k < sizeOfElement; ++k) {
        const vertex = corners[sizeOfElement * element + k];
        const distance = hit.point.distanceToSquared(this.position(surface, vertex));
        if (!best || distance < best.distance) best = {surface, vertex, element, distance};
      }
      return best;
    }

    // Of a vertex, on the source if surface is below 0.
    position(surface, vertex) {
      const {positions} = surface < 0 ? this.data.source : this.data.surfaces[surface];
      return new THREE.Vector3().fromArray(positions, 3 * vertex);
    }

    setMark(surface, vertex) {
      this.mark.visible = true;
      this.position(surface, vertex).toArray(this.mark.geometry.attributes.position.array);
      this.mark.geometry.attributes.position.needsUpdate = true;
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
