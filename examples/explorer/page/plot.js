// Round numbers between two others, a certain number of them at most.
function ticks(low, high, count) {
  const power = 10 ** Math.floor(Math.log10((high - low) / count));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power * count >= high - low);
  const first = Math.ceil(low / step - 1e-9);
  const number = (_, i) => Number(((first + i) * step).toPrecision(12));
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, number);
}

function save(name, text) {
  const href = URL.createObjectURL(new Blob([text]));
  Object.assign(document.createElement("a"), { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 1000);
}

// A picture of rows of digits, from the bottom up.
function coloured(cells) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [cells[0].length, cells.length];
  const pen = canvas.getContext("2d");
  const colours = ["#64748b40", "#0ea5e938", "#0ea5e938", "#f59e0b38", "#f59e0b38"];
  const dot = (cell, i, j) => {
    pen.fillStyle = colours[cell % colours.length];
    pen.fillRect(i, j, 1, 1);
  };
  cells.reverse().forEach((row, j) => [...row].forEach((cell, i) => dot(cell, i, j)));
  return canvas.toDataURL();
}

// A plot in SVG: axes, curves and dots. `fromZero` names the axes that start there; `press(x, y)`
// and `hover(x, y)` are called where the pointer is.
class Plot {
  series = [];

  constructor(id, title, xLabel, yLabel, fromZero) {
    Object.assign(this, { xLabel, yLabel, fromZero });
    this.figure = document.getElementById(id);
    this.figure.innerHTML = `<figcaption><h2>${title}</h2><output></output>
      <button>CSV</button><button>SVG</button></figcaption><svg role="img" aria-label="${title}">`;
    this.svg = this.figure.querySelector("svg");
    const [csv, svg] = this.figure.querySelectorAll("button");
    csv.onclick = () => save(`${id}.csv`, this.csv());
    svg.onclick = () => save(`${id}.svg`, this.picture());
    this.svg.onpointerdown = this.svg.onpointermove = (event) => this.point(event);
    new ResizeObserver(() => this.draw()).observe(this.svg);
  }

  // Draws in the next frame, with these changes.
  draw(changes) {
    Object.assign(this, changes);
    this.frame ??= requestAnimationFrame(() => {
      this.frame = null;
      if (this.series.length) this.paint();
    });
  }

  point({ offsetX, offsetY, buttons }) {
    if (!this.range) return;
    const { range, box } = this;
    const x = range.x[0] + ((offsetX - box.left) / box.width) * (range.x[1] - range.x[0]);
    const y = range.y[1] - ((offsetY - box.top) / box.height) * (range.y[1] - range.y[0]);
    if (x < range.x[0] || x > range.x[1] || y < range.y[0] || y > range.y[1]) return;
    const text = `${this.xLabel} = ${x.toPrecision(4)}, ${this.yLabel} = ${y.toPrecision(4)}`;
    this.figure.querySelector("output").textContent = text;
    this.hover?.(x, y);
    if (buttons) this.press?.(x, y);
  }

  bounds(axis) {
    const curves = this.series.filter((series) => !series.class.includes("mark"));
    const values = curves.flatMap((series) => series[axis]).filter((value) => value !== null);
    const fromZero = this.fromZero.includes(axis);
    const low = values.reduce((a, b) => Math.min(a, b), fromZero ? 0 : Infinity);
    const high = values.reduce((a, b) => Math.max(a, b), -Infinity);
    if (fromZero && axis === "x") return [low, high];
    // A margin, with round ends, so that the axes rest while a slider moves a little.
    const margin = 0.1 * (high - low) || 0.5;
    const round = ticks(low - margin, high + margin, 40);
    return [fromZero ? low : round[0], round.at(-1)];
  }

  paint() {
    const { clientWidth: width, clientHeight: height } = this.svg;
    const range = { x: this.bounds("x"), y: this.bounds("y") };
    const legend = this.legend(width);
    const box = { left: 50, top: 28 + 16 * legend.rows, width: width - 62 };
    box.height = height - box.top - 36;
    Object.assign(this, { range, box });
    const bottom = box.top + box.height;
    const x = (u) => box.left + ((u - range.x[0]) / (range.x[1] - range.x[0])) * box.width;
    const y = (v) => bottom - ((v - range.y[0]) / (range.y[1] - range.y[0])) * box.height;
    const parts = [this.cells ? this.image(x, y) : "", legend.text];
    const line = (name, path) => parts.push(`<path class="${name}" d="${path}"/>`);
    const text = (u, v, anchor, label, more = "") =>
      parts.push(`<text x="${u}" y="${v}" text-anchor="${anchor}" ${more}>${label}</text>`);
    for (const u of ticks(...range.x, width / 75)) {
      line("grid", `M${x(u)} ${bottom}V${box.top}`);
      text(x(u), bottom + 16, "middle", u);
    }
    for (const v of ticks(...range.y, height / 45)) {
      line("grid", `M${box.left} ${y(v)}h${box.width}`);
      text(box.left - 6, y(v) + 4, "end", v);
    }
    text(box.left + box.width / 2, height - 4, "middle", this.xLabel);
    text(4, 15, "start", this.yLabel);
    const isMark = (series) => series.class.includes("mark");
    // Names of neighbours stand below each other, as long as there is room.
    let [last, level] = [-Infinity, 0];
    for (const { name, x: [u] } of this.series.filter(isMark).sort((a, b) => a.x[0] - b.x[0])) {
      level = x(u) - last < 16 ? level + 1 : 0;
      last = x(u);
      line("mark", `M${last} ${bottom}V${box.top}`);
      const [right, down] = [last < box.left + 16 ? last + 12 : last - 4, box.top + 4 + 96 * level];
      const turned = `transform="rotate(-90 ${right} ${down})"`;
      if (down + 96 < bottom) text(right, down, "end", `${name} ${u.toPrecision(4)}`, turned);
    }
    for (const series of this.series.filter((one) => !isMark(one))) {
      line(series.class, this.path(series, x, y));
    }
    if (this.cursor >= range.x[0] && this.cursor <= range.x[1]) {
      line("start", `M${x(this.cursor)} ${bottom}V${box.top}`);
    }
    if (this.dot) line("start point", `M${x(this.dot[0])} ${y(this.dot[1])}h.01`);
    this.svg.innerHTML = parts.join("");
  }

  path(series, x, y) {
    const at = (u, i) => {
      const v = series.y[i];
      return u !== null && v !== null ? `${x(u).toFixed(1)} ${y(v).toFixed(1)}` : "";
    };
    const points = series.x.map(at);
    if (series.class.includes("point")) return points.map((point) => `M${point}h.01`).join("");
    return points.map((point, i) => point && (points[i - 1] ? "L" : "M") + point).join("");
  }

  legend(width) {
    const drawn = this.series.filter(({ class: name, x }) => x.length && !name.includes("mark"));
    let [left, rows, text] = [50, 0, ""];
    for (const [name, style] of new Map(drawn.map((series) => [series.name, series.class]))) {
      const [at, length] = style.includes("point") ? [10, 0.01] : [0, 16];
      const size = 38 + 6.3 * name.length;
      if (left + size > width && left > 50) [left, rows] = [50, rows + 1];
      const y = 11 + 16 * rows;
      text += `<path class="${style}" d="M${left + 4 + at} ${y}h${length}"/>
        <text x="${left + 26}" y="${y + 4}">${name}</text>`;
      left += size;
    }
    return { rows, text };
  }

  // The basins, below the curves.
  image(x, y) {
    const { cells, left, right, low, high } = this.cells;
    this.cells.url ??= coloured(cells);
    return `<image href="${this.cells.url}" preserveAspectRatio="none" x="${x(left)}"
      y="${y(high)}" width="${x(right) - x(left)}" height="${y(low) - y(high)}"/>`;
  }

  csv() {
    const rows = ({ name, x, y }) => x.map((u, i) => `"${name}",${u ?? ""},${y[i] ?? ""}\n`);
    return `series,${this.xLabel},"${this.yLabel}"\n` + this.series.flatMap(rows).join("");
  }

  // The plot with its colours written out, for any program.
  picture() {
    const copy = this.svg.cloneNode(true);
    const copies = [copy, ...copy.querySelectorAll("*")];
    const names = ["fill", "font", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap"];
    [this.svg, ...this.svg.querySelectorAll("*")].forEach((element, i) => {
      const style = getComputedStyle(element);
      for (const name of names) copies[i].style.setProperty(name, style.getPropertyValue(name));
    });
    copy.setAttribute("viewBox", `0 0 ${this.svg.clientWidth} ${this.svg.clientHeight}`);
    copy.style.background = getComputedStyle(document.body).backgroundColor;
    return new XMLSerializer().serializeToString(copy);
  }
}
