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
  const cracks = frames.map((frame) => take(Float32Array, 6 * frame.cracks));
  const parts = take(Uint16Array, nodes);
  // each state is stored as its difference from the one before
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
  // behind the nodes six corners for each crack: a thin rhombus along it
  const most = Math.max(...cracks.map((list) => list.length)), corners = [[1, 0], [0, 0.12], [-1, 0], [1, 0], [0, -0.12], [-1, 0]];
  const moved = new Float32Array(2 * nodes + 2 * most), values = new Float32Array(nodes + most), places = new Float32Array(2 * nodes + 2 * most);
  places.set(positions);
  const setPlaces = attribute("position", 2, places), setMoved = attribute("displacement", 2, moved), setValues = attribute("value", 1, values);
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
  let view = whole(), at = head.opensAt, timer = 0;
  const choice = part("field"), slider = part("state"), magnification = part("magnification"), withEdges = part("edges");
  const scale = part("parts"), withCracks = part("lines"), ends = [part("low"), part("high")];
  head.fields.forEach((field, k) => choice.add(new Option(field.name, k)));
  // what colours mean: of each part its own range, that of one part for all, that of all, or what is typed
  const EACH = -1, ALL = -2, CHOSEN = -3;
  if (head.parts.length > 1) {
    scale.add(new Option("each part by itself", EACH));
    head.parts.forEach((name, k) => scale.add(new Option(`as in ${name}`, k)));
  }
  scale.add(new Option("all parts together", ALL));
  scale.add(new Option("from", CHOSEN));
  slider.max = frames.length - 1;
  frames.forEach((frame, k) => {
    if (!frame.name) return;
    const button = document.createElement("button");
    [button.type, button.textContent, button.onclick] = ["button", frame.name, () => show(k)];
    part("marks").append(button, " ");
  });
  // colours mean the same on either background
  const dark = matchMedia("(prefers-color-scheme: dark)");
  // four digits, as everywhere in the report
  const raised = (text) => text.replace(/./g, (letter) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[letter] || "⁻");
  const number = (value) => {
    if (value === null || !Number.isFinite(value)) return "–";
    const [mantissa, exponent] = value.toExponential(3).split("e");
    const text = value === 0 || (exponent > -5 && exponent < 6) ? +value.toPrecision(4) + ""
      : `${+mantissa}·10${raised(exponent.replace("+", ""))}`;
    return text.replace("-", "−");
  };
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

  // range of the values of some parts; none where they have no value
  const rangeOf = (field, which) => which.map((k) => field.ranges[k]).filter((range) => range && range[0] !== null).reduce(
    (all, range) => all ? [Math.min(all[0], range[0]), Math.max(all[1], range[1])] : range, null);
  const every = head.parts.map((_, k) => k);
  // range of the colours of a part: a part without values cannot lend its own
  const colorsOf = (field, k) => {
    const chosen = +scale.value === EACH ? k : +scale.value;
    if (chosen === CHOSEN) return ends.map((end) => end.valueAsNumber);
    return (chosen === ALL ? null : rangeOf(field, [chosen])) || rangeOf(field, every);
  };
  const valueOf = (field, i, share) => {
    const own = field.ranges[parts[i]], value = between(own, share);
    // less than a step is nothing
    return Math.abs(value) < (own[1] - own[0]) / 65534 ? 0 : value;
  };
  // ends of the bar; ≤ and ≥ where values lie beyond them
  const key = (field) => {
    const unit = field.unit ? " " + field.unit : "";
    if (+scale.value === EACH) {
      const own = every.map((k) => [head.parts[k], rangeOf(field, [k])]).filter(([, range]) => range);
      if (own.length > 1) {
        const end = (k) => own.map(([name, range]) => `${name} ${number(range[k])}`).join(", ");
        return [end(0), end(1) + unit];
      }
    }
    const [least, most] = colorsOf(field, every[0]), [low, high] = rangeOf(field, every);
    return [(low < least ? "≤ " : "") + number(least), (high > most ? "≥ " : "") + number(most) + unit];
  };

  const draw = () => {
    const state = displacements[at], shown = fields[choice.value][at], field = head.fields[choice.value];
    for (let i = 0; i < state.length; i++) moved[i] = between(head.displacement, state[i]);
    const scales = every.map((k) => [field.ranges[k], colorsOf(field, k)]);
    for (let i = 0; i < nodes; i++) {
      const [own, [low, high]] = scales[parts[i]];
      const share = high > low ? (between(own, shown[i]) - low) / (high - low) : 0.5;
      values[i] = shown[i] === 65535 ? 2 : Math.min(Math.max(share, 0), 1);
    }
    const lines = !withCracks || withCracks.checked ? cracks[at] : [];
    for (let i = 0; i < lines.length; i += 6) {
      const [x, y, u, v, a, b] = lines.subarray(i, i + 6);
      corners.forEach(([along, across], k) => {
        const to = 2 * (nodes + i + k);
        [places[to], places[to + 1], moved[to], moved[to + 1]] = [x + along * a - across * b, y + along * b + across * a, u, v];
      });
    }
    setPlaces(places);
    setMoved(moved);
    setValues(values);
    const [x, y] = reach();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...(dark.matches ? [0.086, 0.094, 0.106] : [1, 1, 1]), 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.uniform2f(uniform("middle"), view.x, view.y);
    gl.uniform2f(uniform("reach"), x, y);
    gl.uniform1f(uniform("magnification"), +magnification.value);
    // the background with its edges, then the rest
    [0, 1].forEach((layer) => [0, 1].forEach((kind) => {
      if (kind === 1 && !withEdges.checked) return;
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices[kind]);
      const perItem = kind ? 2 : 3, left = frames[at].left[kind];
      const [start, stop] = layer ? [head.behind[kind], kind ? head.edges : head.triangles] : [0, head.behind[kind]];
      const items = (from, count) => gl.drawElements(kind ? gl.LINES : gl.TRIANGLES, perItem * count, gl.UNSIGNED_INT, 4 * perItem * from);
      // bits that have spalled are shadows
      gl.uniform4f(uniform("line"), 0.5, 0.5, 0.5, 0.2);
      if (kind === 0) items(start + left[layer], stop - start - left[layer]);
      gl.uniform4f(uniform("line"), 0, 0, 0, 0.22 * kind);
      items(start, left[layer]);
    }));
    gl.uniform4f(uniform("line"), 0.894, 0, 0.169, 1);
    gl.drawArrays(gl.TRIANGLES, nodes, lines.length);
    slider.value = at;
    const frame = frames[at];
    const greatest = Math.max(...frames.map((other) => Math.abs(other.load || 0)));
    // what rounding leaves of the load is 0
    const load = Math.abs(frame.load) < 1e-9 * greatest ? 0 : frame.load;
    part("readout").textContent = `${frame.name ? frame.name + ": " : ""}slip ${number(frame.slip)} mm, load ${number(load)} N`;
    slider.setAttribute("aria-valuetext", part("readout").textContent);
    [...part("marks").children].forEach((button) => button.setAttribute("aria-pressed", button.textContent === frame.name));
    [part("least").textContent, part("most").textContent] = key(field);
    plot(part("curve"), [{ x: head.curve[0], y: head.curve[1], color: "#0072b2" }], "slip [mm]", "load [N]", [frame.slip, frame.load]);
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
    [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = dark.matches ? ["#ccc", "#555", ratio] : ["#444", "#bbb", ratio];
    pen.strokeRect(left, top, toX(rangeX[1]) - left, height - bottom - top);
    pen.textAlign = "right";
    rangeY.forEach((value, k) => pen.fillText(texts[k], left - 4 * ratio, toY(value) + 4 * ratio));
    pen.textAlign = "center";
    pen.fillText(nameX, (left + width) / 2, height - 4 * ratio, width - left);
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
    plot(target, lines, head.along + " [mm]", "pressure (–), bond (- -) [MPa]", null, ranges);
  };

  const show = (state) => { at = Math.min(Math.max(state, 0), frames.length - 1); requestAnimationFrame(draw); };
  slider.oninput = () => show(+slider.value);
  [choice, scale, magnification, withEdges, withCracks].filter(Boolean).forEach((control) => { control.onchange = () => {
    // what is typed begins with the range of all
    if (control === choice || control === scale) rangeOf(head.fields[choice.value], every).forEach((end, k) => { ends[k].value = +end.toPrecision(4); });
    part("chosen").hidden = +scale.value !== CHOSEN;
    show(at);
  }; });
  for (const end of ends) end.oninput = () => { if (ends[0].valueAsNumber < ends[1].valueAsNumber) draw(); };
  part("picture").onclick = () => {
    draw();
    canvas.toBlob((picture) => {
      const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(picture), download: `state-${at + 1}.png` });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
  };
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
  // zooms, and moves what lay there to where this place of the canvas is
  const zoom = (factor, there, event) => {
    view.zoom = Math.min(Math.max(view.zoom * factor, 0.5), 400);
    hold(there, event);
  };
  const hold = (there, event) => {
    const here = under(event);
    view.x += there[0] - here[0];
    view.y += there[1] - here[1];
    show(at);
  };
  const middle = () => ({ offsetX: canvas.clientWidth / 2, offsetY: canvas.clientHeight / 2 });
  // the wheel by itself scrolls the page; a touch pad's pinch comes with Ctrl
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / (event.deltaMode ? 12 : 400)), under(event), event);
  }, { passive: false });
  // two fingers pinch and pan, one scrolls the page
  let pinch = null;
  const fingers = (event) => {
    const box = canvas.getBoundingClientRect();
    const [a, b] = [...event.touches].map((touch) => [touch.clientX - box.left, touch.clientY - box.top]);
    return { offsetX: (a[0] + b[0]) / 2, offsetY: (a[1] + b[1]) / 2, apart: Math.hypot(a[0] - b[0], a[1] - b[1]) || 1 };
  };
  for (const kind of ["touchstart", "touchmove"]) canvas.addEventListener(kind, (event) => {
    if (event.touches.length !== 2) return;
    if (event.cancelable) event.preventDefault();
    const now = fingers(event);
    if (kind === "touchmove" && pinch) zoom(now.apart / pinch.apart, pinch.there, now);
    pinch = { there: under(now), apart: now.apart };
  }, { passive: false });
  for (const kind of ["touchend", "touchcancel"]) canvas.addEventListener(kind, () => { pinch = null; });
  part("closer").onclick = () => zoom(1.5, under(middle()), middle());
  part("further").onclick = () => zoom(1 / 1.5, under(middle()), middle());
  const reset = () => { view = whole(); show(at); };
  part("all").onclick = reset;
  const keys = (target, actions) => target.addEventListener("keydown", (event) => {
    const action = event.ctrlKey || event.metaKey || event.altKey ? null : actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
  const pan = (x, y) => () => {
    const [width, height] = reach();
    view.x += 0.2 * x * width;
    view.y += 0.2 * y * height;
    show(at);
  };
  const [closer, further] = [part("closer").onclick, part("further").onclick];
  keys(canvas, { "+": closer, "=": closer, "-": further, "0": reset, ArrowLeft: pan(-1, 0), ArrowRight: pan(1, 0),
    ArrowUp: pan(0, 1), ArrowDown: pan(0, -1) });
  keys(part("curve"), { ArrowLeft: () => show(at - 1), ArrowRight: () => show(at + 1), Home: () => show(0),
    End: () => show(frames.length - 1) });
  let held = null;
  canvas.onpointerdown = (event) => {
    showValue(event);
    if (event.pointerType === "touch") return;
    held = under(event);
    canvas.setPointerCapture(event.pointerId);
  };
  canvas.onpointerup = canvas.onpointercancel = () => { held = null; };
  canvas.onpointermove = (event) => { if (held) hold(held, event); else if (event.pointerType !== "touch") showValue(event); };
  // the value at the nearest node
  const showValue = (event) => {
    const here = under(event);
    let nearest = -1, least = Infinity;
    for (let i = 0; i < nodes; i++) {
      const x = positions[2 * i] + magnification.value * moved[2 * i] - here[0];
      const y = positions[2 * i + 1] + magnification.value * moved[2 * i + 1] - here[1];
      if (x * x + y * y < least) [least, nearest] = [x * x + y * y, i];
    }
    const field = head.fields[choice.value], share = fields[choice.value][at][nearest];
    const own = head.parts.length > 1 ? `${head.parts[parts[nearest]]}: ` : "";
    part("here").textContent = share === 65535 ? "" : `${own}${field.name} ${number(valueOf(field, nearest, share))} ${field.unit}`;
  };
  canvas.ondblclick = reset;
  dark.onchange = () => show(at);
  new ResizeObserver(() => show(at)).observe(canvas);
  show(at);
})();
