// The viewer of a specimen's report: its deformed mesh with a field, over the run. WebGL 2, no library, no network.
(async () => {
  const root = document.getElementById("viewer");
  const part = (name) => root.querySelector("." + name);
  const head = JSON.parse(part("head").textContent);
  const packed = Uint8Array.from(atob(part("data").textContent), (letter) => letter.charCodeAt(0));
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  const buffer = await new Response(unpacked).arrayBuffer();
  let place = 0;
  const take = (Type, length) => {
    const values = new Type(buffer, place, length);
    place += length * Type.BYTES_PER_ELEMENT;
    return values;
  };
  const nodes = head.nodes, frames = head.frames;
  const positions = take(Float32Array, 2 * nodes);
  const triangles = take(Uint32Array, 3 * head.triangles);
  const edges = take(Uint32Array, 2 * head.edges);
  const contacts = frames.map((frame) => take(Float32Array, 6 * frame.contacts));
  // each state is told by its difference to the one before
  const series = (width) => frames.map(() => take(Uint16Array, width)).map((state, k, all) => {
    if (k > 0) for (let i = 0; i < width; i++) state[i] += all[k - 1][i];
    return state;
  });
  const displacements = series(2 * nodes);
  const fields = head.fields.map(() => series(nodes));
  const between = ([low, high], share) => low + (high - low) * share / 65534;

  const canvas = part("mesh"), gl = canvas.getContext("webgl2", { alpha: false, antialias: true });
  if (!gl) { part("none").hidden = false; return; }
  part("stage").hidden = false;
  const compile = (type, text) => {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, "#version 300 es\nprecision highp float;\n" + text);
    gl.compileShader(shader);
    return shader;
  };
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl.VERTEX_SHADER, `in vec2 position, displacement; in float value; out float v;
    uniform vec2 middle, reach; uniform float magnification;
    void main() { v = value; gl_Position = vec4((position + magnification * displacement - middle) / reach, 0, 1); }`));
  gl.attachShader(program, compile(gl.FRAGMENT_SHADER, `in float v; out vec4 color; uniform sampler2D colors; uniform vec4 line;
    void main() { color = line.a > 0.0 ? line : v > 1.5 ? vec4(.82, .82, .82, 1) : texture(colors, vec2(v, .5)); }`));
  gl.linkProgram(program);
  gl.useProgram(program);
  const attribute = (name, size, values) => {
    const target = gl.createBuffer(), where = gl.getAttribLocation(program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, target);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(where);
    gl.vertexAttribPointer(where, size, gl.FLOAT, false, 0, 0);
    return (changed) => { gl.bindBuffer(gl.ARRAY_BUFFER, target); gl.bufferSubData(gl.ARRAY_BUFFER, 0, changed); };
  };
  attribute("position", 2, positions);
  const moved = new Float32Array(2 * nodes), values = new Float32Array(nodes);
  const setMoved = attribute("displacement", 2, moved), setValues = attribute("value", 1, values);
  const indices = [triangles, edges].map((list) => {
    const target = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, target);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, list, gl.STATIC_DRAW);
    return target;
  });
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  const texels = new Uint8Array(head.colors.flatMap((color) => [1, 3, 5].map((k) => parseInt(color.slice(k, k + 2), 16)).concat(255)));
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, head.colors.length, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
  for (const name of ["MAG_FILTER", "MIN_FILTER"]) gl.texParameteri(gl.TEXTURE_2D, gl["TEXTURE_" + name], gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  const uniform = (name) => gl.getUniformLocation(program, name);

  // of the first and of the last state
  const extent = [0, 1].map((k) => {
    let low = Infinity, high = -Infinity;
    for (let i = k; i < positions.length; i += 2) {
      const end = positions[i] + between(head.displacement, displacements[frames.length - 1][i]);
      [low, high] = [Math.min(low, positions[i], end), Math.max(high, positions[i], end)];
    }
    return [low, high];
  });
  const whole = () => ({ x: (extent[0][0] + extent[0][1]) / 2, y: (extent[1][0] + extent[1][1]) / 2, zoom: 1 });
  let view = whole(), at = frames.length - 1, timer = 0;
  const choice = part("field"), slider = part("state"), magnification = part("magnification"), withEdges = part("edges");
  head.fields.forEach((field, k) => choice.add(new Option(field.name, k)));
  slider.max = frames.length - 1;
  // colours mean the same on either background
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const number = (value) => value === null ? "–" : +value.toPrecision(4) + "";
  const size = (target) => {
    const ratio = devicePixelRatio || 1, box = target.getBoundingClientRect();
    const [width, height] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
    if (target.width !== width || target.height !== height) [target.width, target.height] = [width, height];
    return [width, height, ratio];
  };
  const reach = () => {
    const [width, height] = size(canvas);
    const half = extent.map(([low, high]) => 0.54 * (high - low));
    const unit = Math.max(half[0] / width, half[1] / height) / view.zoom;
    return [unit * width, unit * height];
  };

  // whether values go beyond the least (0) or the greatest (1) colour
  const isBeyond = (field, end) => end ? field.values[1] > field.range[1] : field.values[0] < field.range[0];

  const draw = () => {
    const state = displacements[at], shown = fields[choice.value][at], field = head.fields[choice.value];
    for (let i = 0; i < state.length; i++) moved[i] = between(head.displacement, state[i]);
    for (let i = 0; i < nodes; i++) values[i] = shown[i] === 65535 ? 2 : shown[i] / 65534;
    setMoved(moved);
    setValues(values);
    const [x, y] = reach();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...(dark.matches ? [0.086, 0.094, 0.106] : [1, 1, 1]), 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.uniform2f(uniform("middle"), view.x, view.y);
    gl.uniform2f(uniform("reach"), x, y);
    gl.uniform1f(uniform("magnification"), +magnification.value);
    // what lies behind with its edges, then the rest
    [0, 1].forEach((layer) => [0, 1].forEach((kind) => {
      if (kind === 1 && !withEdges.checked) return;
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices[kind]);
      gl.uniform4f(uniform("line"), 0, 0, 0, 0.22 * kind);
      const perItem = kind ? 2 : 3, left = frames[at].left[kind];
      const start = layer ? head.behind[kind] : 0;
      gl.drawElements(kind ? gl.LINES : gl.TRIANGLES, perItem * left[layer], gl.UNSIGNED_INT, 4 * perItem * start);
    }));
    slider.value = at;
    const frame = frames[at];
    part("told").textContent = `slip ${number(frame.slip)} mm, load ${number(frame.load)} N`;
    part("least").textContent = number(field.range[0]);
    const beyond = isBeyond(field, 0) || isBeyond(field, 1);
    const ends = beyond ? `; values from ${number(field.values[0])} to ${number(field.values[1])}` : "";
    part("most").textContent = `${number(field.range[1])} ${field.unit}${ends}`;
    plot(part("curve"), [{ x: head.curve[0], y: head.curve[1], color: "#0072b2" }], "slip, mm", "load, N", [frame.slip, frame.load]);
    contact();
  };

  // a plot of lines with its ranges at the axes
  const plot = (target, lines, nameX, nameY, mark, ranges) => {
    const [width, height, ratio] = size(target), pen = target.getContext("2d");
    const all = (key) => lines.flatMap((line) => line[key]).filter(Number.isFinite);
    const span = (list) => list.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [0, 0]);
    const [rangeX, rangeY] = ranges || [span(all("x")), span(all("y"))];
    pen.font = `${11 * ratio}px system-ui, sans-serif`;
    // what rounding leaves is 0
    const texts = rangeY.map((value) => number(Math.abs(value) < 1e-9 * (rangeY[1] - rangeY[0]) ? 0 : value));
    const widest = Math.max(...texts.map((text) => pen.measureText(text).width));
    const [left, bottom, top] = [Math.max(46 * ratio, widest + 8 * ratio), 30 * ratio, 14 * ratio];
    const toX = (x) => left + (width - left - 10 * ratio) * (x - rangeX[0]) / (rangeX[1] - rangeX[0] || 1);
    const toY = (y) => height - bottom - (height - bottom - top) * (y - rangeY[0]) / (rangeY[1] - rangeY[0] || 1);
    pen.clearRect(0, 0, width, height);
    [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = ["#444", "#bbb", ratio];
    pen.strokeRect(left, top, toX(rangeX[1]) - left, height - bottom - top);
    pen.textAlign = "right";
    rangeY.forEach((value, k) => pen.fillText(texts[k], left - 4 * ratio, toY(value) + 4 * ratio));
    pen.textAlign = "center";
    pen.fillText(nameX, (left + width) / 2, height - 4 * ratio);
    rangeX.forEach((value, k) => { pen.textAlign = k ? "right" : "left"; pen.fillText(number(value), toX(value), height - bottom + 12 * ratio); });
    pen.textAlign = "left";
    pen.fillText(nameY, left, top - 4 * ratio);
    lines.forEach((line) => {
      pen.beginPath();
      pen.strokeStyle = line.color;
      pen.setLineDash(line.dash ? [4 * ratio, 3 * ratio] : []);
      pen.lineWidth = 1.5 * ratio;
      line.x.forEach((x, i) => pen.lineTo(toX(x), toY(line.y[i])));
      pen.stroke();
    });
    pen.setLineDash([]);
    if (mark) {
      pen.beginPath();
      pen.fillStyle = "#d55e00";
      pen.arc(toX(mark[0]), toY(mark[1]), 4 * ratio, 0, 7);
      pen.fill();
    }
    target.slipAt = (pixel) => rangeX[0] + (pixel * ratio - left) / (toX(rangeX[1]) - left) * (rangeX[1] - rangeX[0]);
  };

  // pressure and bond along each pair, of the present state; ranges are those of all states
  const columns = (list, pair) => {
    const own = [];
    for (let i = 0; i < list.length; i += 6) if (list[i] === pair) own.push([...list.subarray(i, i + 6)]);
    return own.sort((a, b) => a[3] - b[3]);
  };
  const ranges = [3, 4].map((first) => contacts.reduce(([low, high], list) => {
    for (let i = 0; i < list.length; i += 6) for (let k = first; k < (first === 3 ? 4 : 6); k++) {
      low = Math.min(low, list[i + k]);
      high = Math.max(high, list[i + k]);
    }
    return [low, high];
  }, [0, 0]));
  const palette = ["#d55e00", "#0072b2", "#009e73", "#cc79a7"];
  const contact = () => {
    const target = part("contact");
    if (!target) return;
    const lines = head.pairs.flatMap((_, pair) => {
      const own = columns(contacts[at], pair), x = own.map((point) => point[3]), color = palette[pair % palette.length];
      return [{ x, y: own.map((point) => point[4]), color }, { x, y: own.map((point) => point[5]), color, dash: true }];
    });
    plot(target, lines, head.along + ", mm", "pressure (–), bond (- -), MPa", null, ranges);
  };

  const show = (state) => { at = Math.min(Math.max(state, 0), frames.length - 1); requestAnimationFrame(draw); };
  slider.oninput = () => show(+slider.value);
  [choice, magnification, withEdges].forEach((control) => { control.onchange = () => show(at); });
  part("play").onclick = (event) => {
    event.target.textContent = timer ? "play" : "stop";
    timer = timer ? clearInterval(timer) : setInterval(() => show((at + 1) % frames.length), 180);
  };
  part("curve").onclick = (event) => {
    const slip = event.target.slipAt(event.offsetX);
    show(frames.reduce((best, frame, k) => Math.abs(frame.slip - slip) < Math.abs(frames[best].slip - slip) ? k : best, 0));
  };
  const under = (event) => {
    const box = canvas.getBoundingClientRect(), [x, y] = reach();
    return [view.x + x * (2 * event.offsetX / box.width - 1), view.y - y * (2 * event.offsetY / box.height - 1)];
  };
  canvas.onwheel = (event) => {
    event.preventDefault();
    const before = under(event);
    view.zoom = Math.min(Math.max(view.zoom * Math.exp(-event.deltaY / 400), 0.5), 400);
    const after = under(event);
    view.x += before[0] - after[0];
    view.y += before[1] - after[1];
    show(at);
  };
  let held = null;
  canvas.onpointerdown = (event) => { held = under(event); canvas.setPointerCapture(event.pointerId); };
  canvas.onpointerup = () => { held = null; };
  canvas.onpointermove = (event) => {
    const here = under(event);
    if (held) {
      view.x += held[0] - here[0];
      view.y += held[1] - here[1];
      show(at);
      return;
    }
    let nearest = -1, least = Infinity;
    for (let i = 0; i < nodes; i++) {
      const x = positions[2 * i] + magnification.value * moved[2 * i] - here[0];
      const y = positions[2 * i + 1] + magnification.value * moved[2 * i + 1] - here[1];
      if (x * x + y * y < least) [least, nearest] = [x * x + y * y, i];
    }
    const field = head.fields[choice.value], value = fields[choice.value][at][nearest];
    const sign = value === 0 && isBeyond(field, 0) ? "≤ " : value === 65534 && isBeyond(field, 1) ? "≥ " : "";
    part("here").textContent = value === 65535 ? "" : `${field.name} ${sign}${number(between(field.range, value))} ${field.unit}`;
  };
  canvas.ondblclick = () => { view = whole(); show(at); };
  dark.onchange = () => show(at);
  new ResizeObserver(() => show(at)).observe(canvas);
  show(at);
})();
