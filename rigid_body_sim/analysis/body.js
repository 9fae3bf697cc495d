// SPDX-License-Identifier: Apache-2.0
// The moving body of a report: recorded states drawn by WebGL, lit, on a ground grid, with arrows.
// Lengths are relative to data.unit; quaternions are (x, y, z, w).
function bodyView(canvas, data) {
  const gl = canvas.getContext('webgl', {antialias: true});
  if (!gl) { canvas.replaceWith('This browser has no WebGL: the body is not shown.'); return {show() {}}; }
  const shader = (type, text) => {
    const one = gl.createShader(type);
    gl.shaderSource(one, text); gl.compileShader(one);
    return one;
  };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `
    attribute vec3 point, normal, color; uniform mat4 camera; uniform mat3 turn; uniform vec3 at;
    uniform float lit; varying vec3 shade;
    void main() {
      vec3 n = normalize(turn * normal + vec3(1e-9));
      float light = 0.45 + 0.35 * max(dot(n, vec3(0.36, -0.48, 0.8)), 0.0) + 0.2 * n.z;
      shade = color * mix(1.0, light + 0.15, lit);
      gl_Position = camera * vec4(turn * point + at, 1.0);
    }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `
    precision mediump float; varying vec3 shade; uniform float opacity;
    void main() { gl_FragColor = vec4(shade * opacity, opacity); }`));
  gl.linkProgram(program); gl.useProgram(program); gl.enable(gl.DEPTH_TEST);
  const place = name => gl.getUniformLocation(program, name);
  const uniforms = {camera: place('camera'), turn: place('turn'), at: place('at'), lit: place('lit'),
    opacity: place('opacity')};
  const attributes = ['point', 'normal', 'color'].map(name => gl.getAttribLocation(program, name));
  attributes.forEach(one => gl.enableVertexAttribArray(one));
  const buffer = numbers => {
    const one = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, one);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
    return {one, count: numbers.length / 9};
  };
  const sub = (a, b) => a.map((x, k) => x - b[k]), dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = a => { const size = Math.hypot(...a) || 1; return a.map(x => x / size); };
  const rotate = ([x, y, z, w], v) => {
    const t = cross([x, y, z], v).map(c => 2 * c), u = cross([x, y, z], t);
    return v.map((c, k) => c + w * t[k] + u[k]);
  };
  const matrix = q => [[1, 0, 0], [0, 1, 0], [0, 0, 1]].flatMap(e => rotate(q, e));

  // Triangles with a normal at each corner: of the face where edges are sharp, else the mean there.
  function triangles({points, faces, colors, smooth}) {
    const normals = faces.map(([a, b, c]) => cross(sub(points[b], points[a]), sub(points[c], points[a])));
    const key = point => point.map(x => x.toFixed(6)).join(), sums = {};
    if (smooth) faces.forEach((face, k) => face.forEach(v => {
      const sum = sums[key(points[v])] ||= [0, 0, 0];
      normals[k].forEach((x, j) => { sum[j] += x; });
    }));
    return faces.flatMap((face, k) => face.flatMap(v => {
      const mean = smooth ? unit(sums[key(points[v])]) : null;
      const normal = mean && dot(mean, unit(normals[k])) > 0.7 ? mean : unit(normals[k]);
      return [...points[v], ...normal, ...colors[k]];
    }));
  }

  const solids = clear => buffer(data.surfaces.filter(one => one.clear === clear).flatMap(triangles));
  const body = solids(false), shell = solids(true), holder = buffer(data.holder.flatMap(triangles));
  const arrows = data.arrows.map(one => ({...one, buffer: buffer(triangles({...one.mesh,
    colors: one.mesh.faces.map(() => one.color)}))}));
  const shaft = buffer(triangles(data.shaft));
  const lines = [], far = 12, cell = data.cell;
  for (let k = -far; k <= far; k++) {
    for (const [a, b] of [[[k, -far], [k, far]], [[-far, k], [far, k]]]) {
      for (const [x, y] of [a, b]) lines.push(x * cell, y * cell, 0, 0, 0, 1, 0.55, 0.55, 0.57);
    }
  }
  const ground = buffer(lines), trail = gl.createBuffer();
  let yaw = 0.6, pitch = 0.42, distance = 4.6, frame = 0, share = 0, opacity = 1;
  const mix = (values, k, part) => {
    const a = values[k], b = values[Math.min(k + 1, values.length - 1)];
    return a.map((x, j) => x + part * (b[j] - x));
  };
  // the attitude between frame k and the next: slerp, the short way round
  function attitude(k, part) {
    const a = data.orientation[k], next = data.orientation[Math.min(k + 1, data.orientation.length - 1)];
    const cosine = a.reduce((sum, x, j) => sum + x * next[j], 0);
    const b = cosine < 0 ? next.map(x => -x) : next;
    const angle = Math.acos(Math.min(1, Math.abs(cosine)));
    const [u, v] = angle < 1e-4 ? [1 - part, part]
      : [Math.sin((1 - part) * angle) / Math.sin(angle), Math.sin(part * angle) / Math.sin(angle)];
    return a.map((x, j) => u * x + v * b[j]);
  }

  function camera() {
    const eye = [Math.sin(yaw) * Math.cos(pitch), -Math.cos(yaw) * Math.cos(pitch), Math.sin(pitch)].map(x => x * distance);
    const z = unit(eye), x = unit(cross([0, 0, 1], z)), y = cross(z, x), f = 1 / Math.tan(0.36);
    const aspect = canvas.width / canvas.height, near = 0.05, out = 60;
    const rows = [x, y, z].map(axis => [...axis, -dot(axis, eye)]);
    const m = [rows[0].map(c => c * f / aspect), rows[1].map(c => c * f),
      rows[2].map((c, k) => c * (out + near) / (near - out) + (k === 3 ? 2 * out * near / (near - out) : 0)), rows[2].map(c => -c)];
    return [0, 1, 2, 3].flatMap(column => m.map(row => row[column]));
  }

  function draw({one, count}, turn, at, lit, mode, dense = opacity) {
    gl.bindBuffer(gl.ARRAY_BUFFER, one);
    attributes.forEach((place, k) => gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 36, 12 * k));
    gl.uniformMatrix3fv(uniforms.turn, false, turn);
    gl.uniform3fv(uniforms.at, at);
    gl.uniform1f(uniforms.lit, lit);
    gl.uniform1f(uniforms.opacity, dense);
    gl.drawArrays(mode, 0, count);
  }

  function paint() {
    const size = canvas.clientWidth * (window.devicePixelRatio || 1), high = canvas.clientHeight * (window.devicePixelRatio || 1);
    if (canvas.width !== Math.round(size) || canvas.height !== Math.round(high)) { canvas.width = size; canvas.height = high; }
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(uniforms.camera, false, camera());
    const q = attitude(frame, share), position = mix(data.position, frame, share), same = [1, 0, 0, 0, 1, 0, 0, 0, 1];
    const middle = rotate(q, data.middle).map((x, k) => x + position[k]);
    // the world moves against a free body; its grid repeats
    const origin = data.follow ? middle : [0, 0, 0];
    const base = [0, 0, data.floor], [x, y, z, w] = data.slope;
    const [u, v] = rotate([-x, -y, -z, w], sub(origin, base)).map(c => Math.floor(c / (cell * 5)) * cell * 5);
    const near = rotate(data.slope, [u, v, 0]).map((c, k) => c + base[k] - origin[k]);
    draw(ground, matrix(data.slope), near, 0, gl.LINES);
    draw(body, matrix(q), sub(position, origin), 1, gl.TRIANGLES);
    draw(holder, same, sub(sub(middle, data.start), origin), 1, gl.TRIANGLES);
    const along = (mesh, from, value) => {
      const length = Math.hypot(...value);
      if (length < 1e-3) return;
      const z = unit(value), x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z)), y = cross(z, x);
      draw(mesh, [...x, ...y, ...z.map(c => c * length)], sub(from, origin), 1, gl.TRIANGLES);
    };
    data.springs.forEach(({at, anchor}) => {
      const end = rotate(q, at).map((x, k) => x + position[k]);
      along(shaft, anchor, sub(end, anchor));
    });
    const vectors = () => arrows.forEach(arrow => along(arrow.buffer, middle, mix(arrow.values, frame, share)));
    vectors();
    const points = [];
    for (let k = 4 * Math.max(0, frame - 400); k <= 4 * (frame + share); k++) {
      points.push(...rotate(attitude(k >> 2, (k & 3) / 4), data.axis), 0, 0, 1, ...data.trace);
    }
    points.push(...rotate(q, data.axis), 0, 0, 1, ...data.trace);
    gl.bindBuffer(gl.ARRAY_BUFFER, trail);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points), gl.DYNAMIC_DRAW);
    draw({one: trail, count: points.length / 9}, same, sub(middle, origin), 0, gl.LINE_STRIP);
    gl.enable(gl.BLEND); gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA); gl.depthMask(false);
    // the far side first, then the near one
    gl.enable(gl.CULL_FACE);
    for (const side of [gl.FRONT, gl.BACK]) {
      gl.cullFace(side);
      if (shell.count) draw(shell, matrix(q), sub(position, origin), 1, gl.TRIANGLES, 0.35);
    }
    gl.disable(gl.CULL_FACE);
    // what the body hides of the arrows is seen through it
    gl.depthFunc(gl.GREATER);
    opacity = 0.4;
    vectors();
    opacity = 1;
    gl.depthFunc(gl.LESS); gl.disable(gl.BLEND); gl.depthMask(true);
  }

  canvas.onpointerdown = () => {
    canvas.onpointermove = event => {
      yaw -= event.movementX * 0.008;
      pitch = Math.min(1.5, Math.max(-0.2, pitch + event.movementY * 0.008));
      paint();
    };
  };
  window.addEventListener('pointerup', () => { canvas.onpointermove = null; });
  canvas.addEventListener('wheel', event => {
    event.preventDefault();
    distance = Math.min(30, Math.max(1.5, distance * Math.exp(event.deltaY * 0.001)));
    paint();
  }, {passive: false});
  new ResizeObserver(paint).observe(canvas);
  // frame k, and the share of the way to the next one
  return {show(k, part = 0) { frame = k; share = part; paint(); }};
}
