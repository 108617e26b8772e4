// Headings, and fields: name, label, value; and either choices, or least, largest, step, laws.
const ANALYTIC = "polynomial exponential coulomb stribeck";
const FIELDS = [
  ["System"],
  ["v_b", "belt velocity v_b", 0.2, 0, 2, 0.005],
  ["beta", "damping ratio β", 0.05, 0, 0.5, 0.001],
  ["load", "friction load γ²", 1, 0.05, 5, 0.05],
  ["Friction law"],
  ["law", "law", "polynomial", ["polynomial", "exponential", "coulomb", "stribeck", "table"]],
  ["mu_s", "static coefficient μ_s", 0.4, 0, 1.5, 0.01, ANALYTIC],
  ["mu_k", "least kinetic coefficient", 0.25, 0, 1.5, 0.01, ANALYTIC],
  ["v_s", "velocity in which it falls", 0.5, 0.01, 2, 0.01, "polynomial exponential stribeck"],
  ["exponent", "exponent", 1, 1, 4, 1, "stribeck"],
  ["viscous", "viscous coefficient", 0, 0, 0.5, 0.005, "stribeck"],
  ["points", "speeds, coefficients", "0 0.4, 0.1 0.33, 0.3 0.27, 0.8 0.25", , , , "table"],
  ["Force F cos Ωτ"],
  ["force", "force F", 0, 0, 1, 0.01],
  ["frequency", "frequency Ω", 1, 0.05, 3, 0.01],
  ["Start (or click in the plane)"],
  ["u", "displacement u", 0, -3, 3, 0.01],
  ["v", "velocity u′", 0, -3, 3, 0.01],
  ["View"],
  ["time", "time shown", 60, 10, 300, 1],
  ["to", "amplitudes up to", 0.6, 0.1, 5, 0.05],
  ["over", "amplitudes over", "velocity", ["velocity", "frequency"]],
  ["basins", "basins", "hidden", ["hidden", "shown"]],
  ["SI units, if all are given"],
  ["mass", "mass in kg", ""],
  ["spring", "spring in N/m", ""],
  ["normal_load", "normal load in N", ""],
];
const element = (id) => document.getElementById(id);
const form = document.querySelector("form");
const value = (name) => form.elements[name].value;
const rounded = (x) => Number(x.toPrecision(4));
const isForced = () => Number(value("force")) !== 0;
const over = () => (isForced() && value("over") === "frequency" ? "frequency" : "v_b");

let group;
for (const [name, label, , least, largest, step, laws] of FIELDS) {
  if (!label) {
    form.insertAdjacentHTML("beforeend", `<fieldset><legend>${name}</legend></fieldset>`);
    group = form.lastElementChild;
    continue;
  }
  let field = `<input name="${name}" spellcheck="false" aria-label="${label}">`;
  if (step) {
    const ends = `min="${least}" max="${largest}" step="${step}"`;
    field = `<input type="range" data-of="${name}" ${ends} aria-label="${label}">${field}`;
  } else if (least) {
    field = `<select name="${name}"><option>${least.join("<option>")}</select>`;
  }
  group.insertAdjacentHTML("beforeend", `<label><span>${label}</span>${field}</label>`);
  if (laws) group.lastElementChild.dataset.laws = laws;
}

const plots = {
  phase: new Plot("phase", "Phase plane", "u", "u′", "", (u, v, isPressed) => {
    if (isPressed) set({ u: rounded(u), v: rounded(v) });
  }),
  diagram: new Plot("diagram", "Amplitudes", "v_b", "a", "xy", (x, _, isPressed) => {
    if (isPressed) set({ [over()]: rounded(x) });
  }),
  time: new Plot("time", "Motion from the start", "time τ", "u, u′", "x", trace),
  law: new Plot("law", "Friction law", "sliding speed", "μ", "xy"),
};

// Shows the state at a time of the motion in the other plots.
function trace(time) {
  const find = (plot, name) => plots[plot].series.find((series) => series.class.includes(name));
  const [u, v, law] = [find("time", "displacement"), find("time", "velocity"), find("law", "kin")];
  const i = u.x.findIndex((other) => other >= time);
  const speed = Math.abs(v.y[i] - value("v_b"));
  const at = law.x.findIndex((other) => other >= speed);
  plots.phase.draw({ dot: i < 0 ? null : [u.y[i], v.y[i]] });
  plots.law.draw({ dot: at < 0 ? null : [speed, law.y[at]] });
}

// A worker, and the questions that it has still to answer. One that takes longer than this, in
// milliseconds, is stopped when others are asked.
const PATIENCE = 500;
class Desk {
  constructor(module) {
    this.module = module;
    this.start();
  }

  start() {
    this.worker?.terminate();
    this.worker = new Worker(URL.createObjectURL(new Blob([element("worker").textContent])));
    this.worker.postMessage(this.module);
    this.worker.onmessage = ({ data }) => {
      this.job.show(JSON.parse(data));
      this.job = null;
      this.next();
    };
    this.job = null;
  }

  ask(plan) {
    this.plan = plan;
    if (this.job && performance.now() - this.since > PATIENCE) this.start();
    if (!this.job) this.next();
  }

  next() {
    this.job = this.plan.shift();
    this.since = performance.now();
    if (this.job) this.worker.postMessage(this.job.question);
    showState();
  }
}
let quick, slow, timer, drawn;
const errors = {};

function showState() {
  const isBusy = quick.job || slow.job || timer;
  document.documentElement.dataset.state = isBusy ? "computing" : "ready";
}

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
      if (own.length) plot.draw({ series: own, dot: null });
    }
    const text = words.map((sentence) => `<p>${sentence}</p>`).join("");
    if (!error) element("words").innerHTML = text;
  });
}

// What the amplitudes depend on; without a force they hold for all velocities and starts.
function diagramKey() {
  const without = ["time", "basins", ...(isForced() ? [] : ["u", "v", "v_b"])];
  const fields = [...new FormData(form)].filter(([name]) => !without.includes(name));
  return JSON.stringify(fields);
}

function diagram(count, exact) {
  const key = diagramKey();
  if (drawn === key) return [];
  const job = question("diagram", { count, exact }, ({ series, error }) => {
    plots.diagram.figure.classList.toggle("stale", !series.length);
    if (series.length) plots.diagram.draw({ series, xLabel: over() === "v_b" ? "v_b" : "Ω" });
    if (exact) drawn = key;
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
  const given = new URLSearchParams(location.hash.slice(1));
  const fields = FIELDS.filter((field) => field[1]);
  set(Object.fromEntries(fields.map(([name, , value]) => [name, given.get(name) ?? value])));
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
