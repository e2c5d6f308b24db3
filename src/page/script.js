// The view of a page: meshes beside each other, turned together, with layers that can be switched. Asks nothing of any other file.
(async () => {
'use strict';
const stage = document.getElementById('stage'), still = document.getElementById('still');
const given = JSON.parse(document.getElementById('meshes').textContent);
const make = (tag, into, set = {}) => into.appendChild(Object.assign(document.createElement(tag), set));
const canvas = document.createElement('canvas');
const gl = canvas.getContext('webgl2', { antialias: true, preserveDrawingBuffer: true });
if (!gl || !window.DecompressionStream) {
  still.textContent = 'This browser draws no meshes (it has no WebGL 2, or is too old): the pictures are instead.';
  return;
}

// Numbers out of text: base64, zlib, bytes by place, differences.
async function unpack(text) {
  const packed = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
async function numbers(text, stride, width) {
  const bytes = await unpack(text), n = bytes.length / width;
  const out = width === 4 ? new Uint32Array(n) : new Uint16Array(n);
  for (let k = 0; k < n; k++) {
    let raw = 0;
    for (let place = 0; place < width; place++) raw |= bytes[place * n + k] << (8 * place);
    out[k] = (k < stride ? 0 : out[k - stride]) + (width === 4 ? (raw >>> 1) ^ -(raw & 1) : raw);
  }
  return out;
}

// The space that all panes share: its middle is the origin, its diagonal one.
const low = [0, 1, 2].map(k => Math.min(...given.panes.map(pane => pane.min[k])));
const high = [0, 1, 2].map(k => Math.max(...given.panes.map(pane => pane.max[k])));
const middle = low.map((x, k) => (x + high[k]) / 2);
const diagonal = Math.hypot(...low.map((x, k) => high[k] - x)) || 1;
const inside = p => p.map((x, k) => (x - middle[k]) / diagonal);

// Vectors and matrices (by columns).
const add = (a, b, t = 1) => a.map((x, k) => x + t * b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const l = Math.hypot(...a) || 1; return a.map(x => x / l); };
const times = (a, b) => { const m = new Float32Array(16);
  for (let c = 0; c < 4; c++) for (let r = 0; r < 4; r++) for (let k = 0; k < 4; k++) m[4 * c + r] += a[4 * k + r] * b[4 * c + k];
  return m; };

function program(vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, '#version 300 es\nprecision highp float;\n' + text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  const at = {};
  for (let n = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS) - 1; n >= 0; n--) {
    const name = gl.getActiveUniform(made, n).name;
    at[name] = gl.getUniformLocation(made, name);
  }
  return { made, at };
}
const surface = program(`
  layout(location = 0) in vec3 p; layout(location = 1) in vec4 c;
  uniform mat4 m; uniform vec3 low, size;
  out vec3 q, corner; out vec4 colour;
  void main() {
    q = low + p * size; colour = c; gl_Position = m * vec4(q, 1.0);
    int k = gl_VertexID % 3; corner = vec3(k == 0, k == 1, k == 2);
  }`, `
  in vec3 q, corner; in vec4 colour; out vec4 seen;
  uniform vec3 eye, ahead, right, up; uniform float cut, edges;
  void main() {
    if (dot(q, ahead) < cut) discard;
    vec3 n = normalize(cross(dFdx(q), dFdy(q))), to = normalize(eye - q);
    if (dot(n, to) < 0.0) n = -n;
    float light = 0.38 + 0.34 * max(dot(n, to), 0.0) + 0.33 * max(dot(n, normalize(up * 0.8 - right * 0.6 + to * 0.5)), 0.0);
    vec3 base = gl_FrontFacing ? colour.rgb : vec3(0.55, 0.25, 0.15);
    vec3 width = fwidth(corner), near = smoothstep(vec3(0.0), width * 1.3, corner);
    float line = (1.0 - min(near.x, min(near.y, near.z))) * edges * clamp(0.45 / max(width.x, max(width.y, width.z)), 0.12, 0.75);
    seen = vec4(mix(pow(base, vec3(2.2)) * light * 1.08, vec3(0.0), line), 1.0);
    seen.rgb = pow(min(seen.rgb, 1.0), vec3(1.0 / 2.2));
  }`);
const stroke = program(`
  layout(location = 0) in vec3 a; layout(location = 1) in vec3 b;
  uniform mat4 m; uniform vec3 low, size, ahead; uniform vec2 pixels; uniform float width;
  out vec3 q;
  void main() {
    vec3 qa = low + a * size, qb = low + b * size;
    vec4 from = m * vec4(qa, 1.0), to = m * vec4(qb, 1.0);
    float least = 1e-4;
    if (from.w < least && to.w > least) from = mix(from, to, (least - from.w) / (to.w - from.w));
    else if (to.w < least && from.w > least) to = mix(to, from, (least - to.w) / (from.w - to.w));
    vec2 along = (to.xy / to.w - from.xy / from.w) * pixels;
    along = dot(along, along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);
    bool second = gl_VertexID > 1;
    float side = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
    gl_Position = second ? to : from;
    gl_Position.xy += (vec2(-along.y, along.x) * side + along * (second ? 0.5 : -0.5)) * width / pixels * gl_Position.w;
    gl_Position.z -= 4e-4 * gl_Position.w;
    q = second ? qb : qa;
  }`, `
  in vec3 q; uniform vec3 ahead; uniform vec4 colour; uniform float cut; out vec4 seen;
  void main() { if (dot(q, ahead) < cut) discard; seen = colour; }`);

function buffer(data, place, size, kind, each = 0, stride = 0, offset = 0) {
  if (data) { gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer()); gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW); }
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, size, kind, true, stride, offset);
  gl.vertexAttribDivisor(place, each);
}
const parsed = hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16));

// From no difference to much; from below to above. Eyes that lack a kind of cones see both.
const RAMPS = {
  one: [[216, 221, 227], [240, 206, 90], [222, 110, 20], [110, 10, 80]],
  two: [[0, 70, 165], [90, 165, 225], [236, 236, 236], [240, 160, 60], [165, 45, 0]],
};
const ramp = (stops, share) => {
  const at = Math.min(share, 1) * (stops.length - 1), k = Math.min(Math.floor(at), stops.length - 2);
  return stops[k].map((x, n) => Math.round(x + (stops[k + 1][n] - x) * (at - k)));
};
const PLAIN = [176, 190, 205], NONE = [128, 128, 128];

// Some of the vertices, by which the first view is chosen.
const some = [];
const panes = [];
for (const data of given.panes) {
  const pane = { data, low: inside(data.min), size: data.max.map((x, k) => (x - data.min[k]) / diagonal), lines: [], colours: {} };
  const positions = await numbers(data.positions, 3, 2);
  for (let n = 0, by = Math.ceil(data.vertices / 1500) || 1; n < data.vertices; n += by) {
    some.push(pane.low.map((x, k) => x + positions[3 * n + k] / 65535 * pane.size[k]));
  }
  pane.corners = await numbers(data.corners, 1, 4);
  const spread = new Uint16Array(4 * pane.corners.length);
  pane.corners.forEach((v, n) => { for (let k = 0; k < 3; k++) spread[4 * n + k] = positions[3 * v + k]; });
  pane.array = gl.createVertexArray();
  gl.bindVertexArray(pane.array);
  buffer(spread, 0, 3, gl.UNSIGNED_SHORT, 0, 8);
  pane.paint = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, pane.paint);
  gl.bufferData(gl.ARRAY_BUFFER, 4 * pane.corners.length, gl.STATIC_DRAW);
  buffer(null, 1, 4, gl.UNSIGNED_BYTE);
  for (const classes of data.classes) {
    const of = await unpack(classes.data), colours = classes.legend.map(([hex]) => parsed(hex));
    pane.colours[classes.name] = n => colours[of[Math.floor(n / 3)]] || NONE;
  }
  for (const values of data.values) {
    const of = await unpack(values.data), stops = values.signed ? RAMPS.two : RAMPS.one;
    const table = Array.from({ length: 256 }, (_, k) => k === 255 ? NONE : ramp(stops, k / 254));
    pane.colours[values.name] = values.by_triangle ? n => table[of[Math.floor(n / 3)]] : n => table[of[pane.corners[n]]];
  }
  for (const lines of data.lines) {
    if (!lines.count) continue;
    const array = gl.createVertexArray(), packed = await numbers(lines.data, 3, 2);
    gl.bindVertexArray(array);
    buffer(packed, 0, 3, gl.UNSIGNED_SHORT, 1, 12, 0);
    buffer(null, 1, 3, gl.UNSIGNED_SHORT, 1, 12, 6);
    pane.lines.push({ name: lines.name, colour: parsed(lines.colour).map(x => x / 255), array, count: lines.count });
  }
  panes.push(pane);
}
gl.bindVertexArray(null);

// What is chosen.
const state = { which: 'both', colour: '', shown: new Set(), edges: false, cut: 0 };
const camera = { yaw: -0.9, pitch: 0.45, distance: 1, target: [0, 0, 0] };
const FIELD = 0.5;
let ring = null, wanted = false;
const visible = () => state.which === 'both' ? panes : [panes[state.which]];

// The frame: canvas, names, marks.
const frame = make('div', stage, { className: 'canvas' });
frame.appendChild(canvas);
canvas.tabIndex = 0;
canvas.setAttribute('aria-label', 'The meshes in 3D. Arrow keys turn them, + and - zoom.');
const split = make('div', frame, { className: 'split' });
for (const pane of panes) {
  pane.name = make('span', frame, { className: 'name', textContent: pane.data.title });
  pane.ring = make('span', frame, { className: 'ring', hidden: true });
  pane.marks = pane.data.marks.flatMap(layer => layer.marks.map(([at, text]) => {
    const mark = make('span', frame, { className: 'mark', textContent: text });
    mark.style.background = layer.colour;
    return { layer: layer.name, at: inside(at), mark };
  }));
}

function paint() {
  for (const pane of panes) {
    const of = pane.colours[state.colour], colours = new Uint8Array(4 * pane.corners.length);
    for (let n = 0; n < pane.corners.length; n++) {
      const [r, g, b] = of ? of(n) : PLAIN;
      colours[4 * n] = r; colours[4 * n + 1] = g; colours[4 * n + 2] = b; colours[4 * n + 3] = 255;
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, pane.paint);
    gl.bufferData(gl.ARRAY_BUFFER, colours, gl.STATIC_DRAW);
  }
  draw();
}

// Rectangles of the panes, in pixels of the page.
function areas() {
  const [w, h] = [frame.clientWidth, frame.clientHeight], shown = visible(), n = shown.length, beside = w > h * 0.9;
  return shown.map((pane, k) => beside
    ? { pane, x: k * w / n, y: 0, w: w / n, h }
    : { pane, x: 0, y: k * h / n, w, h: h / n });
}
function axes() {
  const { yaw, pitch } = camera;
  const back = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
  const right = [-Math.sin(yaw), Math.cos(yaw), 0];
  return { back, right, up: cross(back, right) };
}
function matrix(area) {
  const { back, right, up } = axes(), eye = add(camera.target, back, camera.distance);
  const near = Math.max(camera.distance - 1.6, camera.distance * 0.02), far = camera.distance + 1.6;
  const f = 1 / Math.tan(FIELD / 2), aspect = area.w / area.h;
  const tall = Math.min(1, aspect);
  const projection = [f * tall / aspect, 0, 0, 0, 0, f * tall, 0, 0, 0, 0, (near + far) / (near - far), -1, 0, 0, 2 * near * far / (near - far), 0];
  const look = [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
  return { m: times(projection, look), eye };
}
function draw() { if (!wanted) { wanted = true; requestAnimationFrame(render); } }

function render() {
  wanted = false;
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const [w, h] = [Math.max(1, Math.round(frame.clientWidth * ratio)), Math.max(1, Math.round(frame.clientHeight * ratio))];
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  gl.disable(gl.SCISSOR_TEST);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  const { back, right, up } = axes(), ahead = back.map(x => -x);
  // From the nearest corner to the farthest one, along the view.
  const cut = state.cut > 0 ? -0.5 + state.cut / 100 : -1e9;
  const all = areas();
  for (const pane of panes) if (!all.some(area => area.pane === pane)) hide(pane);
  for (const area of all) {
    const { pane } = area, { m, eye } = matrix(area);
    const box = [area.x * ratio, h - (area.y + area.h) * ratio, area.w * ratio, area.h * ratio].map(Math.round);
    gl.viewport(...box);
    gl.useProgram(surface.made);
    gl.uniformMatrix4fv(surface.at.m, false, m);
    for (const [name, value] of Object.entries({ low: pane.low, size: pane.size, eye, ahead, right, up })) gl.uniform3fv(surface.at[name], value);
    gl.uniform1f(surface.at.cut, cut);
    gl.uniform1f(surface.at.edges, state.edges ? 1 : 0);
    gl.bindVertexArray(pane.array);
    gl.drawArrays(gl.TRIANGLES, 0, pane.corners.length);
    gl.useProgram(stroke.made);
    gl.uniformMatrix4fv(stroke.at.m, false, m);
    for (const [name, value] of Object.entries({ low: pane.low, size: pane.size, ahead })) gl.uniform3fv(stroke.at[name], value);
    gl.uniform1f(stroke.at.cut, cut);
    gl.uniform2f(stroke.at.pixels, box[2], box[3]);
    gl.uniform1f(stroke.at.width, 2.6 * ratio);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    for (const lines of pane.lines) {
      if (!state.shown.has(lines.name)) continue;
      gl.bindVertexArray(lines.array);
      // What is behind the surface is seen faintly.
      for (const [compare, alpha] of [[gl.GREATER, 0.25], [gl.LEQUAL, 1]]) {
        gl.depthFunc(compare);
        gl.depthMask(alpha === 1);
        gl.uniform4f(stroke.at.colour, ...lines.colour, alpha);
        gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, lines.count);
      }
      gl.depthMask(true);
      gl.depthFunc(gl.LESS);
    }
    gl.disable(gl.BLEND);
    label(area, m);
  }
  split.hidden = all.length < 2;
  if (all.length > 1) {
    const beside = all[1].x > 0;
    Object.assign(split.style, { left: all[1].x + 'px', top: all[1].y + 'px', width: beside ? '1px' : '100%', height: beside ? '100%' : '1px' });
  }
  canvas.dataset.camera = [camera.yaw, camera.pitch, camera.distance, ...camera.target].map(x => x.toFixed(4)).join(' ');
  canvas.dataset.drawn = '1';
}
function hide(pane) {
  pane.name.hidden = pane.ring.hidden = true;
  pane.marks.forEach(({ mark }) => { mark.hidden = true; });
}
function put(span, at, area, m) {
  const w = m[3] * at[0] + m[7] * at[1] + m[11] * at[2] + m[15];
  const x = (m[0] * at[0] + m[4] * at[1] + m[8] * at[2] + m[12]) / w, y = (m[1] * at[0] + m[5] * at[1] + m[9] * at[2] + m[13]) / w;
  span.hidden = !(w > 0 && Math.abs(x) < 1 && Math.abs(y) < 1);
  if (!span.hidden) span.style.transform = `translate(${area.x + (x + 1) / 2 * area.w}px, ${area.y + (1 - y) / 2 * area.h}px) translate(-50%, -50%)`;
}
function label(area, m) {
  const { pane } = area;
  pane.name.hidden = false;
  Object.assign(pane.name.style, { left: area.x + 8 + 'px', top: area.y + 8 + 'px' });
  for (const { layer, at, mark } of pane.marks) if (state.shown.has(layer)) put(mark, at, area, m); else mark.hidden = true;
  if (ring) put(pane.ring, ring, area, m); else pane.ring.hidden = true;
}

// The controls.
const controls = make('div', stage, { className: 'controls' });
const group = title => { const set = make('fieldset', controls); make('legend', set, { textContent: title }); return set; };
if (panes.length > 1) {
  const row = make('div', group('Meshes'), { className: 'row' });
  const buttons = [['both', panes.length > 2 ? 'All' : 'Both'], ...panes.map((pane, n) => [n, pane.data.title])].map(([which, text]) => {
    const button = make('button', row, { type: 'button', textContent: text });
    button.onclick = () => { state.which = which; buttons.forEach(b => b.setAttribute('aria-pressed', b === button)); draw(); };
    button.setAttribute('aria-pressed', which === 'both');
    return button;
  });
}
const unique = names => [...new Set(names)];
const colourings = unique(panes.flatMap(pane => Object.keys(pane.colours)));
const legend = document.createElement('div');
function explain() {
  legend.replaceChildren();
  const classes = panes.flatMap(pane => pane.data.classes).filter(c => c.name === state.colour);
  const entries = new Map();
  if (classes.some(c => c.legend.some(([, text, count]) => count && !text))) return;
  for (const [colour, text, count] of classes.flatMap(c => c.legend)) {
    if (count) entries.set(text, [colour, Math.max(count, (entries.get(text) || [])[1] || 0)]);
  }
  for (const [text, [colour, count]] of entries) {
    const line = make('div', legend, { className: 'entry' });
    make('span', line, { className: 'swatch' }).style.background = colour;
    make('span', line, { textContent: text });
    make('span', line, { className: 'count', textContent: count.toLocaleString('en') });
  }
  const values = panes.flatMap(pane => pane.data.values).find(v => v.name === state.colour);
  if (values) {
    const stops = values.signed ? RAMPS.two : RAMPS.one;
    make('div', legend, { className: 'ramp' }).style.background = `linear-gradient(90deg, ${stops.map(c => `rgb(${c})`).join(', ')})`;
    const ends = make('div', legend, { className: 'ends' });
    values.ends.forEach(text => make('span', ends, { textContent: text }));
    make('div', legend, { className: 'note', textContent: values.meaning });
  }
}
const colouring = group('Colour');
for (const name of ['', ...colourings]) {
  const line = make('label', colouring), input = make('input', line, { type: 'radio', name: 'colour', value: name });
  make('span', line, { textContent: name || 'Plain' });
  input.checked = name === (colourings.includes(given.first) ? given.first : '');
  if (input.checked) state.colour = name;
  input.onchange = () => { state.colour = name; explain(); paint(); };
}
colouring.appendChild(legend);
const layers = new Map();
for (const pane of panes) for (const layer of [...pane.data.lines, ...pane.data.marks]) {
  const held = layers.get(layer.name) || { colour: layer.colour, all: 0 };
  held.all = Math.max(held.all, layer.all);
  layers.set(layer.name, held);
}
if (layers.size) {
  const set = group('Layers');
  for (const [name, { colour, all }] of layers) {
    const line = make('label', set), input = make('input', line, { type: 'checkbox', value: name, checked: true });
    make('span', line, { className: 'swatch' }).style.background = colour;
    make('span', line, { textContent: name });
    make('span', line, { className: 'count', textContent: all.toLocaleString('en') });
    state.shown.add(name);
    input.onchange = () => { state.shown[input.checked ? 'add' : 'delete'](name); draw(); };
  }
}
const looks = group('View');
const edges = make('input', make('label', looks), { type: 'checkbox', value: 'edges' });
make('span', edges.parentNode, { textContent: 'Edges of triangles' });
edges.onchange = () => { state.edges = edges.checked; draw(); };
const opening = make('label', looks);
make('span', opening, { textContent: 'Cut open' });
const slider = make('input', opening, { type: 'range', min: 0, max: 100, value: 0 });
slider.style.flex = '1';
slider.style.minWidth = '0';
slider.oninput = () => { state.cut = Number(slider.value); draw(); };
make('button', make('div', looks, { className: 'row' }), { type: 'button', textContent: 'Whole view', onclick: () => { ring = null; chosen(null); fly({ ...start }); } });
make('div', looks, { className: 'note', textContent: 'Drag turns, wheel or pinch zooms, right button or two fingers move. Inner sides are rust red.' });

// Where the camera goes: at first so near that all meshes are seen whole.
function whole() {
  const { back, right, up } = axes(), [{ w, h }] = areas(), aspect = w / h || 1, f = 1 / Math.tan(FIELD / 2) * Math.min(1, aspect) / 0.92;
  const ends = axis => { const along = some.map(p => dot(p, axis)); return [Math.min(...along), Math.max(...along)]; };
  const middleOf = axis => { const [a, b] = ends(axis); return (a + b) / 2; };
  const target = add(right.map(x => x * middleOf(right)), up, middleOf(up));
  const distance = Math.max(...some.map(p => add(p, target, -1)).map(p => dot(p, back) + f * Math.max(Math.abs(dot(p, right)) / aspect, Math.abs(dot(p, up)))));
  return { ...camera, target, distance: distance || 1 };
}
stage.hidden = false;
const start = whole();
Object.assign(camera, start);
let flight = 0;
function fly(to) {
  const number = ++flight, from = { ...camera }, began = performance.now();
  const turn = Math.atan2(Math.sin(to.yaw - from.yaw), Math.cos(to.yaw - from.yaw));
  const long = window.matchMedia('(prefers-reduced-motion: reduce)').matches ? 1 : 450;
  const step = now => {
    if (number !== flight) return;
    const t = Math.min(1, Math.max(0, (now - began) / long)), s = t * t * (3 - 2 * t);
    camera.yaw = from.yaw + turn * s;
    camera.pitch = from.pitch + (to.pitch - from.pitch) * s;
    camera.distance = from.distance * Math.pow(to.distance / from.distance, s);
    camera.target = add(from.target.map(x => x * (1 - s)), to.target, s);
    draw();
    if (t < 1) requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}
function chosen(row) { document.querySelectorAll('tr.chosen').forEach(other => other.classList.remove('chosen')); if (row) row.classList.add('chosen'); }
for (const row of document.querySelectorAll('tr[data-at]')) {
  const list = name => row.dataset[name].split(' ').map(Number);
  const show = () => {
    const at = inside(list('at')), given = list('from'), outwards = Math.hypot(...given) > 0.1 ? unit(given) : null;
    const to = { ...camera, target: at, distance: Math.min(start.distance, Math.max(0.12, 3.2 * Number(row.dataset.size) / diagonal)) };
    if (outwards) Object.assign(to, { yaw: Math.atan2(outwards[1], outwards[0]) + 0.3, pitch: Math.max(-1.3, Math.min(1.3, Math.asin(outwards[2]) + 0.15)) });
    ring = at;
    chosen(row);
    fly(to);
    frame.scrollIntoView({ block: 'nearest' });
  };
  row.classList.add('place');
  const cell = row.cells[0], button = document.createElement('button');
  button.type = 'button';
  button.textContent = cell.textContent;
  button.title = 'Show the place';
  cell.replaceChildren(button);
  row.onclick = show;
}

// Hands: pointers, wheel, keys.
const pointers = new Map();
const move = (dx, dy) => {
  const { right, up } = axes(), scale = 2 * camera.distance * Math.tan(FIELD / 2) / Math.min(frame.clientHeight, frame.clientWidth);
  camera.target = add(add(camera.target, right, -dx * scale), up, dy * scale);
};
const turn = (dx, dy) => { camera.yaw -= dx * 0.008; camera.pitch = Math.max(-1.55, Math.min(1.55, camera.pitch + dy * 0.008)); };
const zoom = factor => { camera.distance = Math.max(0.01, Math.min(8, camera.distance * factor)); };
canvas.addEventListener('pointerdown', event => { flight++; canvas.setPointerCapture(event.pointerId); pointers.set(event.pointerId, event); });
for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, event => pointers.delete(event.pointerId));
canvas.addEventListener('pointermove', event => {
  const before = pointers.get(event.pointerId);
  if (!before) return;
  const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
  if (pointers.size > 1) {
    const other = [...pointers.values()].find(p => p.pointerId !== event.pointerId);
    const apart = p => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY) || 1;
    zoom(apart(before) / apart(event));
    move(dx / 2, dy / 2);
  } else if (event.buttons & 6 || event.shiftKey) move(dx, dy);
  else turn(dx, dy);
  pointers.set(event.pointerId, event);
  draw();
});
canvas.addEventListener('contextmenu', event => event.preventDefault());
canvas.addEventListener('wheel', event => { event.preventDefault(); flight++; zoom(Math.exp(Math.sign(event.deltaY) * 0.12)); draw(); }, { passive: false });
canvas.addEventListener('keydown', event => {
  const done = { ArrowLeft: () => turn(-20, 0), ArrowRight: () => turn(20, 0), ArrowUp: () => turn(0, -20), ArrowDown: () => turn(0, 20), '+': () => zoom(0.85), '-': () => zoom(1.18) }[event.key];
  if (done) { event.preventDefault(); flight++; done(); draw(); }
});

document.documentElement.classList.add('live');
new ResizeObserver(draw).observe(frame);
explain();
paint();
})().catch(error => {
  document.documentElement.classList.remove('live');
  document.getElementById('stage').hidden = true;
  document.getElementById('still').textContent = 'The meshes cannot be drawn here, so the pictures are instead: ' + error.message;
});
