"use strict";
(async () => {
  const part = (id) => document.getElementById(id);
  const page = crypto.randomUUID();
  const begin = await (await fetch("start")).json();
  let library = begin.library;
  let given = begin.document;      // what the lab was opened with: its steps are the path "as given"
  let ghosts = [], curves = [], shown = null, law = null, kind = given.kind;

  const make = (tag, properties = {}, ...children) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  };
  const tidy = (value) => Number.isFinite(value) ? String(Number(value.toPrecision(6))) : "–";
  const copy = (value) => structuredClone(value);

  // ---- material -------------------------------------------------------------------------------------------------------------

  const isOwn = () => library.named !== null;
  const described = () => isOwn() ? library.description?.laws ?? [] : begin.laws;
  let values = {};                 // PROPS by name, or by number
  let names = [];                  // names of constants of a library without metadata

  /** The ends of a slider, and whether it runs by powers of ten. */
  const range = ({ default: preset, usual, lower, upper }, value) => {
    const size = Math.abs(value || preset || 1);
    let [low, high] = usual ?? [0, 2 * size];
    if (preset !== 0 && high > 20 * size) high = 20 * size;
    if (preset !== 0 && low > 0 && low < size / 20) low = size / 20;
    low = Math.max(Math.min(low, value), lower ?? -Infinity);
    high = Math.min(Math.max(high, value), upper ?? Infinity);
    return { low, high: high > low ? high : low + size, byPowers: low > 0 && high > 20 * low };
  };

  /** Numbers that can be fitted, by their places in the case: label, usual range, reader and writer; the case has the factor times what is shown. */
  const numbers = new Map();
  /** A number with its slider; `change` hears what it becomes; `place`: where the case has it. */
  const control = (name, unit, doc, value, bounds, change, place = null, factor = 1) => {
    const { low, high, byPowers } = range(bounds, value);
    const steps = 1000;
    const toPlace = (v) => byPowers ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low);
    const toValue = (p) => byPowers ? low * (high / low) ** p : low + p * (high - low);
    const label = unit && unit !== "-" ? `${name}, ${unit}` : name;
    const number = make("input", { type: "number", step: "any", value: tidy(value), ariaLabel: label });
    const slider = make("input", { type: "range", min: 0, max: steps, step: 1, value: Math.round(steps * toPlace(value)), ariaLabel: `${label}, slider` });
    slider.oninput = () => { const v = Number(toValue(slider.value / steps).toPrecision(4)); number.value = v; change(v); };
    number.oninput = () => {
      if (number.value === "" || !Number.isFinite(number.valueAsNumber)) return;
      slider.value = Math.round(steps * Math.min(Math.max(toPlace(number.valueAsNumber), 0), 1));
      change(number.valueAsNumber);
    };
    if (place !== null) numbers.set(place, { label, factor, bounds: [low, high], value: () => number.valueAsNumber, become: (v) => { number.value = v; number.oninput(); } });
    const caption = make("span", { className: "name", title: doc ?? "" }, name, unit && unit !== "-" ? make("small", {}, ` ${unit}`) : "");
    return make("div", { className: "parameter" }, caption, number, slider);
  };

  const parameterControls = () => {
    const rows = [], group = law.group;
    const single = group ? law.parameters.slice(0, law.parameters.length - group.size) : law.parameters;
    for (const p of single) {
      const change = (value) => { values[p.name] = value; changed(); };
      if (p.choices.length) {
        const select = make("select", { ariaLabel: p.name }, ...p.choices.map((choice) => make("option", { value: choice.name }, choice.name)));
        const present = values[p.name] ?? p.default;
        select.value = p.choices.find((choice) => choice.value === present || choice.name === present)?.name;
        select.onchange = () => change(select.value);
        rows.push(make("div", { className: "parameter" }, make("span", { className: "name", title: p.doc }, p.name), select));
      } else {
        rows.push(control(p.name, p.unit, p.doc, values[p.name] ?? p.default, p, change, `material.props.${p.name}`));
      }
    }
    if (group) {
      const repeated = law.parameters.slice(-group.size);
      const field = make("input", { type: "text", ariaLabel: group.name, value: JSON.stringify(values[group.name] ?? groupDefault(group)) });
      const rowsNow = () => JSON.parse(field.value), place = `material.props.${group.name}.`;
      const list = () => {
        for (const other of numbers.keys()) if (other.startsWith(place)) numbers.delete(other);
        rowsNow().forEach((row, k) => repeated.forEach((p, n) => {
          const { low, high } = range(p, row[n]), of = p.unit === "-" ? "" : `, ${p.unit}`;
          const become = (v) => { const next = rowsNow(); next[k][n] = v; field.value = JSON.stringify(next); field.oninput(); };
          numbers.set(`${place}${k}.${n}`, { label: `${p.name} ${k + 1}${of}`, factor: 1, bounds: [low, high], value: () => rowsNow()[k][n], become });
        }));
      };
      list();
      field.oninput = () => {
        try { values[group.name] = JSON.parse(field.value); list(); showFree(); field.setCustomValidity(""); changed(); } catch (error) { field.setCustomValidity(error.message); }
      };
      const columns = repeated.map((p) => p.unit === "-" ? p.name : `${p.name} ${p.unit}`).join(", ");
      rows.push(make("label", {}, `${group.name}: rows of ${columns} `, field));
    }
    return rows;
  };
  const groupDefault = (group) => Array.from({ length: group.minimum }, () => law.parameters.slice(-group.size).map((p) => p.default));

  const constantControls = () => (Array.isArray(values) ? values : []).map((value, k) => {
    const row = control(names[k] ?? `PROPS(${k + 1})`, "", "", value, { default: value, usual: null }, (next) => { values[k] = next; changed(); }, `material.props.${k}`);
    row.firstChild.replaceChildren(make("input", { type: "text", value: names[k] ?? `PROPS(${k + 1})`, ariaLabel: `Name of PROPS(${k + 1})`,
      onchange: (event) => { names[k] = event.target.value; } }));
    return row;
  });

  /** Numbers of a mix that come first: name, unit, least, greatest, factor to what the case has. */
  const STEEL = 7850;
  const mix = {
    volume_fraction: ["Fibre content (steel)", "kg/m³", 5, 150, 1 / STEEL],
    "fibre.length": ["Fibre length", "mm", 10, 80, 1],
    "fibre.diameter": ["Fibre diameter", "mm", 0.1, 1.5, 1],
    "fibre.tau": ["Bond stress τ", "MPa", 0.5, 15, 1],
    "fibre.strength": ["Fibre strength", "MPa", 400, 3000, 1],
    "fibre.inclination.f": ["Snubbing f", "", 0, 1, 1],
    "matrix.ft": ["Tensile strength of the matrix", "MPa", 1, 8, 1],
    "matrix.Gf": ["Fracture energy of the matrix", "N/mm", 0.02, 0.3, 1],
  };

  const orientations = {
    "random in space": { type: "random3d" },
    "random in a plane": { type: "planar" },
    "between walls": { type: "section", size: [150, 125], faces: { width: 2, height: 1 } },
  };
  /** The orientation of the fibres of a mix. */
  const orientationControl = () => {
    const present = given.orientation ?? orientations["random in space"];
    const known = Object.keys(orientations).find((name) => orientations[name].type === present.type);
    const names = known ? Object.keys(orientations) : ["as given", ...Object.keys(orientations)];
    const select = make("select", { ariaLabel: "Orientation" }, ...names.map((name) => make("option", { value: name }, name)));
    select.value = known ?? "as given";
    select.onchange = () => { given.orientation = select.value === known ? present : copy(orientations[select.value] ?? present); showMaterial(); changed(); };
    return make("div", { className: "parameter" }, make("span", { className: "name" }, "Orientation"), select);
  };

  /** Numbers of a case of another kind, by their places in it: those of a mix first, all others folded below them. */
  const caseControls = () => {
    const first = {}, others = [], known = kind === "bridging" ? mix : {};
    const walk = (node, place) => {
      for (const [key, value] of Object.entries(node)) {
        const at = [...place, key], name = at.join(".");
        if (typeof value === "number" && !Array.isArray(node)) {
          const [title, unit, low, high, factor] = known[name] ?? [name, "", null, null, 1];
          const bounds = { default: value / factor, usual: low === null ? null : [low, high] };
          const row = control(title, unit, name, value / factor, bounds, (next) => { node[key] = next * factor; changed(); }, name, factor);
          if (name in known) first[name] = row; else others.push(row);
        } else if (value && typeof value === "object" && key !== "compare" && key !== "steps") walk(value, at);
      }
    };
    walk(given, []);
    const rows = Object.keys(known).map((name) => first[name]).filter(Boolean);
    return kind !== "bridging" ? others : [...rows, orientationControl(), make("details", {}, make("summary", {}, "All other numbers"), ...others)];
  };

  const showMaterial = () => {
    const isPoint = kind === "point" || kind === "interface";
    const laws = described();
    part("material-title").textContent = { bridging: "Mix", pullout: "Specimen" }[kind] ?? "Material";
    part("law-label").hidden = !isPoint || (isOwn() && laws.length === 0);
    part("law").replaceChildren(...laws.map(({ name }) => make("option", { value: name }, name.replaceAll("_", " "))));
    const wanted = isOwn() ? given.material?.cmname?.toLowerCase() ?? laws[0]?.name : given.material?.plugin;
    law = laws.find(({ name }) => name === wanted) ?? null;
    if (law) part("law").value = law.name;
    const isGuessed = isOwn() && !law && !begin.document.steps.length && values.length > 0;
    part("about").textContent = law?.description ?? (isGuessed ? "Constants and states are counted in the source. The values are placeholders: type yours." : "");
    part("file").hidden = !isOwn();
    if (isOwn()) part("file").textContent = library.named;
    part("constants").hidden = !isPoint || law !== null;
    part("length-label").hidden = !isPoint;
    if (law?.group?.minimum && !Array.isArray(values)) values[law.group.name] ??= groupDefault(law.group);
    for (const place of document.querySelectorAll(".of-a-law")) place.hidden = !isPoint;
    for (const place of document.querySelectorAll(".of-a-case")) place.hidden = kind === "results";
    part("strengths").parentElement.hidden = !isPoint;
    numbers.clear();
    const rows = kind === "results" ? [] : !isPoint ? caseControls() : law ? parameterControls() : constantControls();
    part("parameters").replaceChildren(...rows);
    showFree();
  };

  part("law").onchange = () => {
    const chosen = described().find(({ name }) => name === part("law").value);
    given = { ...given, material: isOwn() ? { cmname: chosen.name.toUpperCase() } : { plugin: chosen.name } };
    const next = chosen.entry_points.includes("umat") ? "point" : "interface";
    if (next !== kind) { kind = next; given.kind = kind; given.steps = []; }
    values = {};
    showMaterial();
    showPath();
    changed();
  };
  part("more").onclick = () => { values.push(0); showMaterial(); changed(); };
  part("fewer").onclick = () => { values.pop(); showMaterial(); changed(); };
  part("nstatv").oninput = part("length").oninput = () => changed();

  // ---- path -----------------------------------------------------------------------------------------------------------------

  const still = (...strains) => Object.fromEntries(strains.map((name) => [name, "hold"]));
  const ramp = (n, target, more = {}) => ({ increments: n, target, ...more });
  const cycle = (component, fixed = {}) => ({ amplitude: a, increments: n, cycles: c }) =>
    [{ repeat: c, steps: [ramp(n, { [component]: a, ...fixed }), ramp(2 * n, { [component]: -a, ...fixed }), ramp(n, { [component]: 0, ...fixed })] }];
  const shearFixed = (mode) => mode === "3d" ? still("e11", "e22", "e33") : mode === "axisymmetric" ? still("e11", "e22", "e33") : still("e11", "e22");
  const amplitude = ["amplitude", "Strain", 0.01], increments = ["increments", "Increments a ramp", 100], cycles = ["cycles", "Cycles", 2];
  const presets = {
    point: {
      tension: ["Uniaxial tension", [amplitude, increments], (p) => [ramp(p.increments, { e11: p.amplitude })]],
      compression: ["Uniaxial compression", [amplitude, increments], (p) => [ramp(p.increments, { e11: -p.amplitude })]],
      cyclic: ["Uniaxial cycles", [amplitude, increments, cycles], cycle("e11")],
      shear: ["Simple shear", [amplitude, increments], (p) => [ramp(p.increments, { g12: p.amplitude, ...shearFixed(p.mode) })]],
      shearCycles: ["Shear cycles", [amplitude, increments, cycles], (p) => cycle("g12", shearFixed(p.mode))(p)],
      pure: ["Pure shear", [amplitude, increments], (p) => [ramp(p.increments, { e11: p.amplitude, e22: -p.amplitude })]],
      equibiaxial: ["Equibiaxial tension", [amplitude, increments], (p) => [ramp(p.increments, { e11: p.amplitude, e22: p.amplitude })]],
      oedometer: ["Oedometer", [amplitude, increments], (p) => [ramp(p.increments, { e11: -p.amplitude, e22: 0, ...(p.mode === "3d" || p.mode === "axisymmetric" ? { e33: 0 } : {}) })]],
      triaxial: ["Triaxial compression", [amplitude, increments, ["pressure", "Cell pressure, MPa", 1]], (p) => [
        ramp(p.increments, { s11: -p.pressure, s22: -p.pressure, s33: -p.pressure }),
        ramp(p.increments, { e11: -p.amplitude, s22: -p.pressure, s33: -p.pressure })]],
      creep: ["Creep", [["stress", "Stress, MPa", 10], ["time", "Time, s", 100], increments], (p) => [
        ramp(10, { s11: p.stress }, { time: 1e-6 }), ramp(p.increments, { s11: p.stress }, { time: p.time })]],
      relaxation: ["Relaxation", [amplitude, ["time", "Time, s", 100], increments], (p) => [
        ramp(10, { e11: p.amplitude }, { time: 1e-6 }), ramp(p.increments, { e11: "hold" }, { time: p.time })]],
      largeShear: ["Simple shear, large strain (F)", [["amplitude", "Shear", 2], increments], (p) => [{ increments: p.increments, F: [[1, p.amplitude, 0], [0, 1, 0], [0, 0, 1]] }], true],
    },
    interface: {
      slip: ["Slip under pressure", [["slip", "Slip, mm", 1], ["pressure", "Pressure, MPa", 1], increments], (p) => [ramp(1, { p: p.pressure }), ramp(p.increments, { slip: p.slip })]],
      slips: ["Slip cycles", [["slip", "Slip, mm", 0.5], ["pressure", "Pressure, MPa", 1], increments, cycles], (p) => [
        ramp(1, { p: p.pressure }), { repeat: p.cycles, steps: [ramp(p.increments, { slip: p.slip }), ramp(2 * p.increments, { slip: -p.slip }), ramp(p.increments, { slip: 0 })] }]],
      opening: ["Opening", [["gap", "Gap, mm", 0.5], increments], (p) => [ramp(p.increments, { gap: p.gap })]],
    },
  };
  let preset = null, setting = {};

  const showPath = () => {
    const known = presets[kind] ?? {};
    const hasSteps = Array.isArray(given.steps) ? given.steps.length > 0 : true;
    const options = Object.entries(known).map(([key, [title]]) => make("option", { value: key }, title));
    if (hasSteps) options.unshift(make("option", { value: "given" }, "As given"));
    part("path").replaceChildren(...options);
    if (preset === null || (preset === "given" ? !hasSteps : !(preset in known))) preset = hasSteps ? "given" : Object.keys(known)[0];
    part("path").value = preset;
    const modes = law?.modes?.length && kind === "point" ? law.modes : ["3d", "plane_strain", "axisymmetric", "plane_stress", "1d", "beam"];
    const mode = part("mode").value || given.mode || modes[0];
    part("mode").replaceChildren(...modes.map((name) => make("option", { value: name }, name.replace("_", " "))));
    part("mode").value = modes.includes(mode) ? mode : modes[0];
    part("mode-label").hidden = kind !== "point";
    showSettings();
  };
  const showSettings = () => {
    const wanted = presets[kind]?.[preset]?.[1] ?? [];
    part("settings").replaceChildren(...wanted.map(([key, title, usual]) => {
      const value = setting[`${preset}.${key}`] ?? usual;
      const isCount = key === "increments" || key === "cycles";
      const change = (next) => { setting[`${preset}.${key}`] = isCount ? Math.max(1, Math.round(next)) : next; changed(); };
      const usualRange = isCount ? [1, key === "cycles" ? 20 : 1000] : null;
      return control(title, "", "", value, { default: isCount ? 0 : usual, usual: usualRange }, change);
    }));
  };
  part("path").onchange = () => { preset = part("path").value; showSettings(); changed(); };
  part("mode").onchange = () => { showSettings(); changed(); };

  // ---- the case -------------------------------------------------------------------------------------------------------------

  const caseNow = () => {
    const document = copy(given);
    if (kind !== "point" && kind !== "interface") return document;
    document.material ??= {};
    if (law) {
      document.material.plugin = isOwn() ? library.library : law.name;
      document.material.props = copy(values);
    } else {
      if (isOwn()) document.material.plugin = library.library;
      document.material.props = copy(values);
      document.material.nstatv = part("nstatv").valueAsNumber || 0;
    }
    if (part("length").value !== "") document.characteristic_length = part("length").valueAsNumber; else delete document.characteristic_length;
    if (kind === "point") document.mode = part("mode").value;
    const chosen = presets[kind][preset];
    if (chosen) {
      const numbers = Object.fromEntries(chosen[1].map(([key, , usual]) => [key, setting[`${preset}.${key}`] ?? usual]));
      document.steps = chosen[2]({ ...numbers, mode: document.mode });
      if (chosen[3]) document.nlgeom = true;
    }
    document.title ??= `${law?.name ?? "user material"}, ${chosen?.[0] ?? "as given"}`.replaceAll("_", " ");
    return document;
  };

  const adopt = (document) => {
    given = document;
    kind = document.kind;
    const props = document.material?.props;
    values = Array.isArray(props) ? [...props] : { ...(props ?? {}) };
    showMaterial();
    if (law && Array.isArray(values)) values = fromOrder(values);
    if (!law && !Array.isArray(values) && (kind === "point" || kind === "interface")) values = [];
    part("nstatv").value = document.material?.nstatv ?? 0;
    part("length").value = document.characteristic_length ?? "";
    if (document.mode) { part("mode").replaceChildren(make("option", { value: document.mode })); part("mode").value = document.mode; }
    preset = null;
    showMaterial();
    showPath();
  };
  const fromOrder = (props) => {
    const size = law.group?.size ?? 0, single = law.parameters.length - size, named = {};
    law.parameters.slice(0, single).forEach((p, k) => { if (k < props.length) named[p.name] = props[k]; });
    if (size && props.length > single) named[law.group.name] = Array.from({ length: (props.length - single) / size }, (_, k) => props.slice(single + k * size, single + (k + 1) * size));
    return named;
  };

  part("apply").onclick = () => {
    try {
      adopt(JSON.parse(part("case").value));
      part("case-error").textContent = "";
      changed();
    } catch (error) { part("case-error").textContent = error.message; }
  };

  // ---- runs: one at a time, the newest next -----------------------------------------------------------------------------------

  const ask = (what, body) => fetch(what, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ page, ...body }) });
  // nothing is computed for a page that is closed
  window.addEventListener("pagehide", () => navigator.sendBeacon("end", JSON.stringify({ page })));
  let isRunning = false, isWaiting = false, verdictTimer = 0;
  const changed = async () => {
    const document = caseNow();
    if (window.document.activeElement !== part("case")) part("case").value = JSON.stringify(document, null, 2);
    clearTimeout(verdictTimer);
    if (isRunning) { isWaiting = true; return; }
    isRunning = true;
    const start = performance.now();
    try {
      const answer = await (await ask("run", { document, ghosts: ghosts.map(({ name, document }) => ({ name, document })), curves })).json();
      if (answer.status !== "superseded") show(answer, document, performance.now() - start);
    } catch (error) {
      part("status").textContent = "the lab has ended: start it again";
    }
    isRunning = false;
    if (isWaiting) { isWaiting = false; changed(); } else verdictTimer = setTimeout(judge, 250);
  };

  const show = (answer, document, elapsed) => {
    const refused = answer.status === "refused";
    const words = refused ? answer.problems.map((problem) => problem.words) : [answer.message, ...(answer.warnings ?? []).map((warning) => `warning: ${warning}`), answer.prints?.trim()].filter(Boolean);
    const build = library.refusal ? [library.refusal] : [];
    part("problems").hidden = words.length + build.length === 0;
    part("problems").textContent = [...build, ...words].join("\n");
    part("figures").classList.toggle("stale", refused);
    part("replay").hidden = !answer.replay;
    if (refused) { part("status").textContent = "the case was refused"; return; }
    shown = { ...answer, document };
    const effort = answer.increments > 0 ? `${answer.increments} increments, ${answer.iterations} iterations, ` : "";
    part("status").textContent = `${answer.status}: ${effort}${answer.milliseconds.toFixed(1)} ms (${Math.round(elapsed)} ms to the picture)`;
    const places = part("figures");
    answer.figures.forEach((figure, k) => {
      const place = places.children[k] ?? places.appendChild(make("figure"));
      place.innerHTML = figure.drawing.svg;
      place.onpointermove = (event) => read(event, place, figure);
      place.onpointerleave = () => place.querySelector(".cursor")?.remove();
    });
    while (places.children.length > answer.figures.length) places.lastChild.remove();
    part("numbers").textContent = (answer.compare ?? []).filter(({ rms }) => rms !== null).map(({ file, rms }) => `RMS difference from ${file}: ${tidy(rms)}`).join(", ");
    if (answer.findings) showStrengths(answer.findings);
    window.dispatchEvent(new CustomEvent("shown"));
  };

  /** What a mix is worth: strengths of the notched beam, and of the crack. */
  const showStrengths = ({ beam, scatter, sigma_peak, sigma_fibre_peak, efficiency, fibres_per_cm2 }) => {
    const strength = (name, value, unit, index = "") => make("tr", {}, make("td", {}, name, make("sub", {}, index)), make("td", {}, tidy(Number(value.toPrecision(4)))), make("td", {}, unit));
    const rows = beam ? [strength("f", beam.f_L, "MPa", "L"), ...beam.f_R.map((value, k) => strength("f", value, "MPa", `R${k + 1}`))] : [];
    rows.push(strength("Greatest σ", sigma_peak, "MPa"), strength("Greatest σ of the fibres", sigma_fibre_peak, "MPa"),
      strength("Orientation factor η", efficiency, ""), strength("Fibres per cm²", fibres_per_cm2, ""));
    part("verdict-title").textContent = "Strengths";
    part("conclusion").textContent = scatter ? `Class ${scatter.class ?? "none"} (fib Model Code 2010)` : "";
    part("strengths").replaceChildren(...rows);
    part("strengths").parentElement.hidden = false;
  };

  /** The values of the point of a curve that is nearest to the pointer. */
  const read = (event, place, { drawing, lines }) => {
    const svg = place.querySelector("svg"), [[left, top], [right, bottom]] = drawing.frame;
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const toX = (x) => left + (x / drawing.x.scale - drawing.x.range[0]) / (drawing.x.range[1] - drawing.x.range[0]) * (right - left);
    const toY = (y) => bottom - (y / drawing.y.scale - drawing.y.range[0]) / (drawing.y.range[1] - drawing.y.range[0]) * (bottom - top);
    let best = null;
    for (const { label, points } of lines) for (const [x, y] of points) {
      if (x === null || y === null) continue;
      const distance = Math.hypot(toX(x) - at.x, toY(y) - at.y);
      if (!best || distance < best.distance) best = { distance, label, x, y };
    }
    if (!best) return;
    place.querySelector(".cursor")?.remove();
    const dot = window.document.createElementNS("http://www.w3.org/2000/svg", "circle");
    for (const [key, value] of Object.entries({ class: "cursor", cx: toX(best.x), cy: toY(best.y), r: 100, fill: "none", stroke: "#d00", "stroke-width": 30 })) dot.setAttribute(key, value);
    svg.append(dot);
    part("cursor").textContent = `${best.label}: ${drawing.x.label} ${tidy(best.x / drawing.x.scale)}, ${drawing.y.label} ${tidy(best.y / drawing.y.scale)}`;
  };

  // ---- verdict --------------------------------------------------------------------------------------------------------------

  const judge = async () => {
    if (kind !== "point" && kind !== "interface") return;
    const document = caseNow(), asked = JSON.stringify(document);
    part("conclusion").textContent = "checking …";
    const answer = await (await ask("check", { document })).json().catch(() => null);
    if (answer === null || answer.status === "superseded" || JSON.stringify(caseNow()) !== asked) return;
    if (answer.problems) {
      part("conclusion").replaceChildren(make("span", { className: "badge" }, "not checked"));
      part("findings").replaceChildren(make("li", {}, answer.problems.map((problem) => problem.words).join("\n")));
      part("rows").replaceChildren();
      return;
    }
    const laws = answer.laws ?? [];
    const verdict = answer.verdict;
    part("conclusion").replaceChildren(make("span", { className: `badge ${verdict}` }, verdict), ` ${laws.map((one) => one.conclusion).join("; ")}`);
    const rows = laws.flatMap((one) => one.rows);
    const line = (row) => make("li", {}, make("span", { className: `badge ${row.verdict}` }, row.verdict), ` ${row.check}, ${row.stress_state}: ${[row.figure, row.detail].filter(Boolean).join(" – ")}`);
    part("findings").replaceChildren(...rows.filter((row) => !["pass", "info", "skipped"].includes(row.verdict)).map(line));
    part("rows").replaceChildren(...rows.map((row) => make("tr", {}, ...[row.verdict, row.check, row.stress_state, row.figure].map((text) => make("td", {}, String(text ?? ""))))));
    window.dispatchEvent(new CustomEvent("judged"));
  };

  // ---- ghosts and measured curves -------------------------------------------------------------------------------------------

  const pin = (document, name) => {
    while (ghosts.some((ghost) => ghost.name === name)) name += " ′";
    ghosts.push({ name, document: copy(document) });
    if (ghosts.length > 6) ghosts.shift();
    showGhosts();
  };
  const showGhosts = () => part("ghosts").replaceChildren(...ghosts.map((ghost, k) => make("li", {},
    make("input", { type: "text", value: ghost.name, ariaLabel: "Name of a pinned curve", onchange: (event) => { ghost.name = event.target.value || ghost.name; changed(); } }),
    make("button", { type: "button", ariaLabel: `Remove ${ghost.name}`, onclick: () => { ghosts.splice(k, 1); showGhosts(); changed(); } }, "Remove"))));
  part("pin").onclick = () => { if (shown) { pin(shown.document, `earlier ${ghosts.length + 1}`); changed(); } };

  part("data").onchange = async () => {
    const file = part("data").files[0];
    if (file) takeData(file.name, await file.text());
  };
  const takeData = (name, text) => {
    const lines = text.split(/\r?\n/).map((line) => line.trim()).filter((line) => line && !line.startsWith("#"));
    const cells = lines.map((line) => line.split(/[,;\t]|\s+/).filter(Boolean));
    const isHead = cells[0]?.some((cell) => !Number.isFinite(Number(cell)));
    const head = isHead ? cells.shift() : cells[0]?.map((_, k) => `column ${k + 1}`) ?? [];
    if (head.length < 2) { part("measured").replaceChildren(make("p", { className: "error" }, `${name}: two columns of numbers are needed`)); return; }
    const columns = kind === "interface" ? ["slip", "tau"] : ["e11", "s11"];
    const pick = (at, label) => make("label", {}, `${label} `, make("select", {}, ...head.map((title, k) => make("option", { value: k, selected: k === at }, title))));
    const target = (value, label) => make("label", {}, `${label} `, make("input", { type: "text", value }));
    const [fx, fy, tx, ty] = [pick(0, "Abscissa"), pick(1, "Ordinate"), target(columns[0], "is the column"), target(columns[1], "and the column")];
    const take = () => {
      const points = cells.map((row) => [Number(row[fx.lastChild.value]), Number(row[fy.lastChild.value])]).filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
      curves = [{ label: name, x: tx.lastChild.value, y: ty.lastChild.value, points }];
      changed();
    };
    for (const field of [fx, fy, tx, ty]) field.lastChild.onchange = take;
    const drop = make("button", { type: "button", onclick: () => { curves = []; part("measured").replaceChildren(); part("data").value = ""; showFree(); changed(); } }, "Remove");
    part("measured").replaceChildren(fx, tx, fy, ty, drop);
    take();
    showFree();
  };
  window.document.ondragover = (event) => event.preventDefault();
  window.document.ondrop = async (event) => {
    event.preventDefault();
    const file = event.dataTransfer.files[0];
    if (file) takeData(file.name, await file.text());
  };

  // ---- fit to data ----------------------------------------------------------------------------------------------------------

  const free = new Map();          // bounds as text by place, of the parameters that may change
  const showFree = () => {
    part("fit").hidden = curves.length === 0 || numbers.size === 0;
    for (const place of free.keys()) if (!numbers.has(place)) free.delete(place);
    part("free").replaceChildren(...[...numbers].map(([place, { label, bounds }]) => {
      const field = (k, title) => make("input", { type: "number", step: "any", value: free.get(place)?.[k] ?? tidy(bounds[k]), ariaLabel: `${title} bound of ${label}` });
      const fields = [field(0, "Lower"), field(1, "Upper")];
      const tick = make("input", { type: "checkbox", checked: free.has(place) });
      const note = () => { if (tick.checked) free.set(place, fields.map((one) => one.value)); else free.delete(place); };
      for (const one of [tick, ...fields]) one.onchange = note;
      return make("tr", {}, make("td", {}, make("label", {}, tick, ` ${label}`)), ...fields.map((one) => make("td", {}, one)));
    }));
  };

  let isFitting = false;
  part("start-fit").onclick = async () => {
    if (isFitting) { ask("fit", { document: {}, free: [] }); return; }
    const document = caseNow(), before = copy(document);
    for (const place of free.keys()) {
      const { value, factor } = numbers.get(place), keys = place.split("."), last = keys.pop();
      keys.reduce((node, key) => node[key], document)[last] = value() * factor;
    }
    const texts = [...free].map(([place, bounds]) => `${place}=${bounds.map((bound) => Number(bound) * numbers.get(place).factor).join(":")}`);
    if (!texts.length) { part("fitted").textContent = "Tick at least one parameter."; return; }
    isFitting = true;
    part("start-fit").textContent = "Stop";
    part("fitted").textContent = "fitting …";
    part("estimates").replaceChildren();
    const answer = await (await ask("fit", { document, curves, free: texts })).json().catch(() => ({ status: "refused", problems: [{ words: "the lab has ended: start it again" }] }));
    isFitting = false;
    part("start-fit").textContent = "Fit";
    if (answer.problems) { part("fitted").textContent = answer.problems.map((problem) => problem.words).join("\n"); return; }
    if (answer.status === "superseded") { part("fitted").textContent = "stopped"; return; }
    const words = [`${answer.runs} runs, RMS difference ${tidy(answer.rms)}`, answer.message, ...answer.warnings].filter(Boolean);
    part("fitted").textContent = words.join("\n");
    part("estimates").replaceChildren(...answer.parameters.map(({ path, value, standard_error, identifiable, on_bound }) => {
      const { label, factor } = numbers.get(path);
      const remark = [identifiable ? "" : "not determined by the data", on_bound === null ? "" : "on its bound"].filter(Boolean).join(", ");
      return make("tr", {}, ...[label, `${tidy(value / factor)} ± ${standard_error === null ? "∞" : tidy(standard_error / factor)}`, remark].map((text) => make("td", {}, text)));
    }));
    pin(before, "before the fit");
    for (const { path, value } of answer.parameters) {
      const { become, factor } = numbers.get(path);
      become(Number((value / factor).toPrecision(10)));
    }
    window.dispatchEvent(new CustomEvent("fitted"));
  };

  // ---- take away ------------------------------------------------------------------------------------------------------------

  const save = (name, text, type = "text/plain") => {
    const link = make("a", { download: name, href: URL.createObjectURL(new Blob([text], { type })) });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const asJson = (document) => JSON.stringify(document, null, 2) + "\n";
  /** The present case as a file has it: with the library or source that the command line named. */
  const caseToKeep = () => {
    const document = caseNow();
    if (isOwn()) document.material.plugin = library.named;
    return document;
  };
  part("save-case").onclick = () => save("case.json", asJson(caseToKeep()), "application/json");
  part("save-python").onclick = () => save("case.py", `import json\n\nimport pullout_fe as po\n\ncase = po.Case(json.loads(r"""\n${asJson(caseToKeep())}"""))\nrun = po.run(case)\nprint(run)\n`);
  part("save-abaqus").onclick = async () => save("material.inp", await (await ask("abaqus", { document: caseNow() })).text());
  part("save-csv").onclick = async () => save("history.csv", await (await ask("csv", { document: caseNow() })).text(), "text/csv");
  part("save-svg").onclick = () => { const first = shown?.figures[0]; if (first) save(`${first.name}.svg`, first.drawing.svg, "image/svg+xml"); };
  part("save-replay").onclick = () => { if (shown?.replay) save("replay.json", asJson(shown.replay), "application/json"); };

  // ---- the user's source ----------------------------------------------------------------------------------------------------

  const follow = async () => {
    for (;;) {
      let next;
      try { next = await (await fetch(`library?after=${library.version}`)).json(); } catch { return; }
      if (next.version === library.version) continue;
      const before = shown?.document, wasGood = library.library;
      library = next;
      if (before && isOwn() && next.library !== wasGood && !next.refusal) {
        ghosts = ghosts.filter((ghost) => ghost.name !== "before the last change");
        pin(before, "before the last change");
      }
      if (isOwn()) showMaterial();
      changed();
    }
  };

  if (begin.has_report) {
    part("title").textContent = given.title;
    part("report").href = "report";
    part("report").parentElement.hidden = false;
  }
  adopt(given);
  if (!isOwn() || library.library) changed(); else { part("problems").hidden = false; part("problems").textContent = library.refusal ?? ""; part("status").textContent = "waiting for a library"; }
  follow();
})();
