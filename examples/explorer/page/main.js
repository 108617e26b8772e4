const element = (id) => document.getElementById(id);
const form = document.querySelector("form");
const program = URL.createObjectURL(new Blob([element("worker").textContent]));
const value = (name) => form.elements[name].value;
const isForced = () => Number(value("force")) !== 0;
const over = () => (isForced() && value("over") === "frequency" ? "frequency" : "v_b");

// Each number with a step has a slider.
for (const field of [...form.querySelectorAll("[step]")]) {
  const { name, min, max, step } = field;
  const slider = { type: "range", min, max, step, ariaLabel: field.parentElement.innerText.trim() };
  field.before(Object.assign(document.createElement("input"), slider));
  field.previousSibling.dataset.of = name;
}

const plots = {
  phase: new Plot("phase", "Phase plane", "u", "u′", ""),
  diagram: new Plot("diagram", "Amplitudes", "v_b", "a", "xy"),
  time: new Plot("time", "Motion from the start", "time τ", "u, u′", "x"),
  law: new Plot("law", "Friction law", "sliding speed", "μ", "xy"),
};
plots.phase.press = (u, v) => set({ u: +u.toPrecision(4), v: +v.toPrecision(4) });
plots.diagram.press = (x) => set({ [over()]: +x.toPrecision(4) });
// The state at a time of the motion, shown in the other plots.
plots.time.hover = (time) => {
  const find = (name) => plots.time.series.find((series) => series.class.includes(name));
  const [u, v] = [find("displacement"), find("velocity")];
  const i = u.x.findIndex((other) => other >= time);
  plots.phase.draw({ dot: [u.y[i], v.y[i]] });
  plots.law.draw({ cursor: Math.abs(v.y[i] - value("v_b")) });
};

// A worker, and the questions that it has still to answer.
class Desk {
  constructor(module) {
    this.module = module;
    this.start();
  }

  start() {
    this.worker?.terminate();
    this.worker = new Worker(program);
    this.worker.postMessage(this.module);
    this.worker.onmessage = ({ data }) => {
      const { show } = this.job;
      this.job = null;
      show(JSON.parse(data));
      this.next();
    };
    this.job = null;
  }

  ask(plan) {
    this.plan = plan;
    // What takes longer than half a second is stopped.
    if (this.job && performance.now() - this.since > 500) this.start();
    if (!this.job) this.next();
  }

  next() {
    this.job = this.plan.shift();
    this.since = performance.now();
    if (this.job) this.worker.postMessage(this.job.question);
    const isBusy = quick.job || slow.job || timer;
    document.documentElement.dataset.state = isBusy ? "computing" : "ready";
  }
}
let quick, slow, timer, drawn;
const errors = {};

// A question about the parameters, with more fields, and what is done with the answer.
function question(kind, more, show) {
  const fields = Object.entries({ ...Object.fromEntries(new FormData(form)), ...more, kind });
  const text = fields.map(([name, value]) => `${name}=${String(value).replace(/\s+/g, " ")}`);
  const answered = (answer) => {
    errors[kind] = answer.error;
    element("error").textContent = [...new Set(Object.values(errors))].filter(Boolean).join("\n");
    show(answer);
  };
  return { question: text.join("\n"), show: answered };
}

function motion() {
  return question("motion", {}, ({ words, series, error }) => {
    for (const [name, plot] of Object.entries(plots)) {
      if (name !== "diagram") plot.figure.classList.toggle("stale", Boolean(error));
      const own = series.filter((one) => one.class.startsWith(name));
      if (own.length) plot.draw({ series: own, dot: null, cursor: NaN });
    }
    element("words").classList.toggle("stale", Boolean(error));
    const text = words.map((sentence) => `<p>${sentence}</p>`).join("");
    if (!error) element("words").innerHTML = text;
  });
}

// The amplitudes, unless they are drawn; without a force they hold for all velocities and starts.
function diagram(count, exact) {
  const without = ["time", "basins", ...(isForced() ? [] : ["u", "v", "v_b"])];
  const fields = [...new FormData(form)].filter(([name]) => !without.includes(name));
  const key = JSON.stringify(fields);
  if (drawn === key) return [];
  const job = question("diagram", { count, exact }, ({ series }) => {
    plots.diagram.figure.classList.toggle("stale", !series.length);
    if (series.length) plots.diagram.draw({ series, xLabel: over() === "v_b" ? "v_b" : "Ω" });
    drawn = exact ? key : null;
  });
  return [job];
}

function basins(columns, rows) {
  if (value("basins") === "hidden" || isForced() || !plots.phase.range) return [];
  const { x, y } = plots.phase.range;
  const area = { left: x[0], right: x[1], low: y[0], high: y[1] };
  const show = ({ cells }) => plots.phase.draw({ cells: cells.length ? { cells, ...area } : null });
  return [question("basins", { ...area, columns, rows }, show)];
}

// After a change: coarse pictures at once, fine ones when nothing has changed for a while.
function changed() {
  for (const label of form.querySelectorAll("[data-laws]")) {
    label.hidden = !label.dataset.laws.includes(value("law"));
  }
  form.elements.over.parentElement.hidden = !isForced();
  form.elements.basins.parentElement.hidden = isForced();
  if (value("basins") === "hidden" || isForced()) plots.phase.draw({ cells: null });
  errors.basins = null;
  plots.diagram.draw({ cursor: Math.abs(value(over())) });
  clearTimeout(timer);
  timer = setTimeout(refine, 200);
  quick.ask([motion()]);
  slow.ask([...(isForced() ? [] : diagram(24, 0)), ...basins(32, 24)]);
}

function refine() {
  timer = null;
  history.replaceState(null, "", `#${new URLSearchParams(new FormData(form))}`);
  slow.ask([...diagram(160, 1), ...basins(200, 150)]);
}

function set(values) {
  for (const [name, value] of Object.entries(values)) {
    form.elements[name].value = value;
    const slider = form.querySelector(`[data-of="${name}"]`);
    if (slider) slider.value = value;
  }
  changed();
}

function readAddress() {
  form.reset();
  const given = [...new URLSearchParams(location.hash.slice(1))];
  const known = given.filter(([name]) => form.elements.namedItem(name));
  set(Object.fromEntries([...new FormData(form), ...known]));
}

(async () => {
  const data = `data:application/gzip;base64,${element("wasm").textContent.trim()}`;
  const packed = (await fetch(data)).body.pipeThrough(new DecompressionStream("gzip"));
  const module = await WebAssembly.compile(await new Response(packed).arrayBuffer());
  [quick, slow] = [new Desk(module), new Desk(module)];
  form.oninput = ({ target }) => set({ [target.name || target.dataset.of]: target.value });
  form.onsubmit = (event) => event.preventDefault();
  window.onhashchange = readAddress;
  readAddress();
})();
