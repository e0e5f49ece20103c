// SPDX-License-Identifier: GPL-3.0-or-later
// The page of `wardmis converge`: reads report.json as it stands in the document, and builds each section that has data.
// What the fields mean is said in docs/report-format.md. Needs Plotly, and nothing else; fetches nothing.
"use strict";
(() => {
  const report = JSON.parse(document.getElementById("report").textContent);
  const configurations = report.configurations;
  const baseline = configurations.find((c) => c.name === report.baseline) || configurations[0];
  const clock = report.clock === "cpu" ? "CPU" : "wall"; // that times and ratios are of
  const effort = report.effort_clock === "wall" ? "wall" : "CPU"; // that products with errors are of
  const product = report.metric === "relmse" ? "Variance" : "Error";
  const known = (x) => x !== null && x !== undefined;
  const filled = (list) => Array.isArray(list) && list.length > 0;

  // ---- DOM -----------------------------------------------------------------------------------------------------------

  // h("p", {class: "x"}, "text", node, [nodes], null): text never becomes markup.
  function h(tag, attributes, ...children) {
    const element = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes || {})) {
      if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
      else if (value !== false && known(value)) element.setAttribute(key, value === true ? "" : value);
    }
    element.append(...children.flat(Infinity).filter(known));
    return element;
  }

  function svg(tag, attributes, ...children) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.append(...children);
    return element;
  }

  // A section, or nothing where every part of it is missing.
  function section(id, title, ...children) {
    const parts = children.flat(Infinity).filter(known);
    return parts.length ? h("section", { id, "aria-labelledby": `${id}-title` }, h("h2", { id: `${id}-title` }, title), parts) : null;
  }

  const read = (text) => h("p", { class: "read" }, text);

  // ---- Numbers -------------------------------------------------------------------------------------------------------

  const kNone = "–";
  const minus = (text) => String(text).replace(/-/g, "−");
  const superscript = (n) => String(n).replace(/./g, (d) => (d === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[d]));
  const integer = (n) => (known(n) ? minus(Math.round(n).toLocaleString("en-US")) : kNone);
  const isPlain = (x) => x === 0 || (Math.abs(x) >= 1e-3 && Math.abs(x) < 1e6);
  const round3 = (x) => Number(x.toPrecision(3));

  // Digits after the point that show three significant ones.
  function decimals(x) {
    const rounded = Math.abs(round3(x));
    return rounded === 0 ? 0 : Math.max(0, 2 - Math.floor(Math.log10(rounded)));
  }

  function fixed(x, digits) {
    const value = digits === 0 && Math.abs(x) >= 1000 ? round3(x) : x;
    return minus(value.toLocaleString("en-US", { minimumFractionDigits: digits, maximumFractionDigits: digits }));
  }

  // As many digits as it needs, at most three.
  const brief = (x) => (isPlain(x) ? minus(round3(x).toLocaleString("en-US", { maximumFractionDigits: 6 })) : number(x));

  // Three significant digits.
  function number(x) {
    if (!known(x)) return kNone;
    if (isPlain(x)) return fixed(x, decimals(x));
    const [mantissa, exponent] = x.toExponential(2).split("e");
    return `${minus(mantissa)} × 10${superscript(Number(exponent))}`;
  }

  // Numbers of a text, "4.6e-06", as those of the page.
  const typeset = (text) =>
    text.replace(/\b(\d(?:\.\d+)?)e([+-]\d+)\b/g, (_, mantissa, exponent) => `${mantissa} × 10${superscript(Number(exponent))}`).replace(/(^|[\s[])-(?=\d)/g, "$1−");

  // "0.620 [0.580, 0.660]" as two parts: the mean to three digits, its bounds to the same place.
  function intervalParts(i) {
    if (!known(i)) return [kNone, "", ""];
    let scale = 1, tail = "";
    if (!isPlain(i.mean)) {
      const exponent = Number(i.mean.toExponential(2).split("e")[1]);
      scale = 10 ** -exponent;
      tail = ` × 10${superscript(exponent)}`;
    }
    const digits = decimals(i.mean * scale);
    const [mean, low, high] = [i.mean, i.low, i.high].map((x) => (known(x) ? fixed(x * scale, digits) : kNone));
    return [mean, ` [${low}, ${high}]`, tail];
  }
  const intervalText = (i) => intervalParts(i).join("");

  function interval(i, word) {
    const [mean, range, tail] = intervalParts(i);
    return h("span", {}, mean, range ? h("span", { class: "range" }, range) : null, tail, word ? h("span", { class: "word" }, word) : null);
  }

  const isTie = (i) => i.low <= 1 + 1e-4 && i.high >= 1 - 1e-4; // as the verdict has it

  // A ratio to the baseline.
  function ratio(i) {
    if (!known(i)) return kNone;
    return isTie(i) ? h("span", { class: "tie" }, interval(i, "tie")) : interval(i);
  }

  function percent(x) {
    if (!known(x)) return kNone;
    const value = 100 * x;
    return `${value === 0 || Math.abs(value) >= 0.001 ? fixed(value, decimals(value)) : number(value)} %`;
  }

  function date(text) {
    const when = new Date(text);
    if (!text || Number.isNaN(when.getTime())) return text || "";
    return `${when.toLocaleDateString("en-GB", { day: "numeric", month: "long", year: "numeric", timeZone: "UTC" })}, ${text.slice(11, 16)} UTC`;
  }

  // ---- How a configuration looks -------------------------------------------------------------------------------------

  // Dashes for Plotly and for the little lines beside names; markers by Plotly's names.
  const STYLES = [
    { dash: "solid", svg: "", marker: "circle" },
    { dash: "10px,4px", svg: "8 3", marker: "square" },
    { dash: "2px,4px", svg: "2 3", marker: "diamond" },
    { dash: "10px,4px,2px,4px", svg: "8 3 2 3", marker: "triangle-up" },
    { dash: "5px,3px", svg: "4 3", marker: "triangle-down" },
    { dash: "16px,5px", svg: "12 4", marker: "pentagon" },
    { dash: "10px,3px,2px,3px,2px,3px", svg: "8 2 2 2 2 2", marker: "hexagon" },
    { dash: "1px,2px", svg: "1 2", marker: "star" },
  ];
  // Plotly selects by it: nothing but letters, digits, "-" and "_".
  const uidOf = (c) => c.name.replace(/[^\w-]/g, (sign) => `_${sign.codePointAt(0).toString(16)}_`);
  // The ninth has the first one's colour, but another dash and marker.
  const indexOf = (c) => configurations.indexOf(c);
  const styleOf = (c) => STYLES[(indexOf(c) + Math.floor(indexOf(c) / 8)) % 8];
  const colourName = (c) => `--c${indexOf(c) % 8}`;
  const colourOf = (c) => css(colourName(c));

  const MARKS = {
    circle: () => svg("circle", { cx: 15, cy: 6, r: 4.2 }),
    square: () => svg("rect", { x: 11.2, y: 2.2, width: 7.6, height: 7.6 }),
    diamond: () => svg("path", { d: "M15 0.8 20.2 6 15 11.2 9.8 6Z" }),
    "triangle-up": () => svg("path", { d: "M15 0.8 20 10H10Z" }),
    "triangle-down": () => svg("path", { d: "M15 11.2 20 2H10Z" }),
    pentagon: () => svg("path", { d: "M15 1 20 4.8 18.1 10.6H11.9L10 4.8Z" }),
    hexagon: () => svg("path", { d: "M10 6 12.5 1.7H17.5L20 6 17.5 10.3H12.5Z" }),
    star: () => svg("path", { d: "M15 0.5 16.6 4.4 20.7 4.6 17.5 7.2 18.6 11.2 15 8.9 11.4 11.2 12.5 7.2 9.3 4.6 13.4 4.4Z" }),
  };

  function swatch(c) {
    const colour = `var(${colourName(c)})`;
    const line = svg("line", { x1: 0, y1: 6, x2: 30, y2: 6, stroke: colour, "stroke-width": 2, "stroke-dasharray": styleOf(c).svg });
    const mark = MARKS[styleOf(c).marker]();
    mark.setAttribute("fill", colour);
    return svg("svg", { class: "swatch", viewBox: "0 0 30 12", "aria-hidden": "true" }, line, mark);
  }

  const isBaseline = (c) => c === baseline && configurations.length > 1;
  const named = (c) => h("span", { class: c.name.length < 20 ? "config short" : "config" }, swatch(c), h("span", {}, c.name, isBaseline(c) ? h("span", { class: "range" }, " (baseline)") : null));
  const namedBriefly = (c) => h("span", { class: "config" }, swatch(c), h("span", {}, c.name)); // where a cell says "baseline"

  // ---- Tables --------------------------------------------------------------------------------------------------------

  // columns: [label, class?]. rows: lists of cells, the first of which names the row: text, a node, or {is, class, style}.
  // Columns in which no row has anything are left out. Roles are said again because narrow pages show rows as blocks.
  function table(label, columns, rows, className) {
    const plain = (cell) => (cell && cell.is !== undefined ? cell : { is: cell });
    const shown = columns.map((_, j) => j === 0 || rows.some((row) => plain(row[j]).is !== kNone && known(plain(row[j]).is)));
    const head = columns.flatMap(([text, kind], j) => (shown[j] ? [h("th", { scope: "col", role: "columnheader", class: kind }, text)] : []));
    const body = rows.map((row) =>
      h("tr", { role: "row" }, row.flatMap((given, j) => {
        const cell = plain(given), [text, kind] = columns[j];
        if (!shown[j]) return [];
        if (j === 0) return [h("th", { scope: "row", role: "rowheader" }, cell.is)];
        const content = known(cell.is) ? cell.is : kNone;
        const classes = [kind, cell.class, content === kNone ? "none" : null].filter(known).join(" ");
        return [h("td", { role: "cell", class: classes || null, style: cell.style, "data-label": text }, content)];
      })));
    const dense = shown.filter((x) => x).length > 6 && className === "heat";
    return h("div", { class: "table" }, h("table", { role: "table", class: dense ? `${className} dense` : className, "aria-label": label },
      h("thead", { role: "rowgroup" }, h("tr", { role: "row" }, head)), h("tbody", { role: "rowgroup" }, body)));
  }

  // Two columns: a name and what is known of it.
  function facts(label, pairs) {
    const rows = pairs.filter(([, value]) => known(value) && value !== "" && value !== kNone);
    return h("table", { role: "table", class: "facts", "aria-label": label }, h("tbody", { role: "rowgroup" },
      rows.map(([name, value]) => h("tr", { role: "row" }, h("th", { scope: "row", role: "rowheader" }, name), h("td", { role: "cell", class: "bare" }, value)))));
  }

  // A bar of shares that add up to one.
  function shareBar(parts) {
    const text = parts.map(([name, x]) => `${name} ${percent(x)}`).join(", ");
    return h("span", { class: "share", role: "img", "aria-label": text, title: text },
      parts.map(([, x, look]) => h("span", { style: `width:${100 * x}%;background:${look}` })));
  }

  // What is said of each configuration in sentences.
  function words(list) {
    const items = list.map(([c, texts]) => [c, texts.filter((t) => t)]).filter(([, texts]) => texts.length);
    return items.length ? h("dl", { class: "words" }, items.map(([c, texts]) => [h("dt", {}, named(c)), h("dd", {}, texts.map(typeset).join(" "))])) : null;
  }

  // ---- Theme and plots -----------------------------------------------------------------------------------------------

  const root = document.documentElement;
  const preference = window.matchMedia("(prefers-color-scheme: dark)");
  let chosenTheme = "auto";
  const css = (name) => getComputedStyle(root).getPropertyValue(name).trim();
  const alpha = (hex, a) => `rgba(${[1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16)).join(",")},${a})`;
  const plots = []; // functions that draw one plot each, again after a change of theme
  const isNarrow = () => window.innerWidth < 720;
  const safe = (text) => String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;"); // Plotly reads some markup

  let printing = false;
  const kPaper = 680; // CSS pixels between the margins of A4 and Letter

  function applyTheme(forced) {
    root.dataset.theme = forced || (chosenTheme === "auto" ? (preference.matches ? "dark" : "light") : chosenTheme);
    for (const draw of plots) draw();
  }

  function themeButton() {
    const text = () => `Colours: ${chosenTheme}`;
    const button = h("button", { class: "theme", type: "button", title: "automatic, light or dark colours", onclick: () => {
      const dark = preference.matches;
      const order = dark ? ["auto", "light", "dark"] : ["auto", "dark", "light"];
      chosenTheme = order[(order.indexOf(chosenTheme) + 1) % 3];
      button.textContent = text();
      applyTheme();
    } }, text());
    return button;
  }

  function layout(more) {
    const axis = { gridcolor: css("--grid"), linecolor: css("--soft"), zeroline: false, ticks: "outside", tickcolor: css("--rule"), ticklen: 4 };
    return {
      paper_bgcolor: css("--paper"), plot_bgcolor: "rgba(0,0,0,0)", hovermode: "closest", dragmode: isNarrow() ? false : "zoom",
      font: { family: getComputedStyle(document.body).fontFamily, size: isNarrow() ? 12 : 13, color: css("--ink") },
      hoverlabel: { bgcolor: css("--panel"), bordercolor: css("--rule"), font: { color: css("--ink"), size: 13 }, align: "left" },
      margin: { l: isNarrow() ? 56 : 70, r: 12, t: 12, b: 50 },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: css("--soft"), activecolor: css("--ink") },
      ...more, xaxis: { ...axis, ...more.xaxis }, yaxis: { ...axis, ...more.yaxis },
    };
  }

  const fileName = (what) => `${report.title}-${what}`.replace(/[^\w.-]+/g, "-");
  const options = (what) => ({
    responsive: true, displaylogo: false, displayModeBar: true, plotlyServerURL: "", showLink: false, showSendToCloud: false,
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d", "zoomIn2d", "zoomOut2d"],
    toImageButtonOptions: { format: "svg", filename: fileName(what), width: 900, height: 560 },
  });

  const short = (name, most) => (name.length > most ? `${name.slice(0, most - 1)}…` : name);

  // `make` gives {traces, layout}; it is drawn once the page stands, and again when colours change.
  function plot(className, label, what, make) {
    const place = h("div", { class: `plot ${className}`, role: "img", "aria-label": label });
    const draw = () => {
      const made = make(place);
      const hidden = new Set((place.data || []).filter((t) => t.visible === "legendonly").map((t) => t.uid));
      for (const trace of made.traces) trace.visible = hidden.has(trace.uid) ? "legendonly" : true;
      if (printing) made.layout.width = place.closest(".pair") ? kPaper / 2 - 20 : kPaper;
      return Plotly.react(place, made.traces, layout(made.layout), options(typeof what === "function" ? what() : what));
    };
    plots.push(draw);
    return { place, draw };
  }

  // ---- 1. Head -------------------------------------------------------------------------------------------------------

  function head() {
    const scene = report.provenance && report.provenance.scene;
    const seeds = (report.seeds || []).length;
    const parts = [
      scene ? `Scene ${scene}` : null, `${report.width} × ${report.height} pixels`, `${seeds} ${seeds === 1 ? "seed" : "seeds"}`,
      date(report.created), `WardMIS\u00a0${report.version}`,
    ];
    return h("header", {},
      h("div", { class: "head" }, h("h1", {}, report.title), themeButton()),
      h("p", { class: "when" }, parts.filter((p) => p).join(" · ")),
      report.complete === false ? h("p", { class: "notice" }, "This study ended before its time: the figures are those of the runs that were done.") : null,
      report.verdict ? h("p", { class: "verdict" }, typeset(report.verdict.text)) : null,
      report.verdict && report.verdict.why.length ? h("p", { class: "why" }, report.verdict.why.map(typeset).join(" ")) : null,
      h("p", { class: "finding" }, report.finding.map(typeset).join(" ")));
  }

  // ---- 2. Error against time -----------------------------------------------------------------------------------------

  const AXES = [
    { key: "wall", name: "wall seconds", title: "Wall seconds, pilot included", of: (p) => p.wall && p.wall.mean, text: (p) => `${intervalText(p.wall)} s wall` },
    { key: "cpu", name: "CPU seconds", title: "CPU seconds, pilot included", of: (p) => p.cpu && p.cpu.mean, text: (p) => `${intervalText(p.cpu)} s CPU` },
    { key: "rays", name: "rays", title: "Rays traced", of: (p) => p.rays, text: (p) => `${number(p.rays)} rays` },
    { key: "spp", name: "samples per pixel", title: "Samples per pixel", of: (p) => p.spp, text: () => null },
  ];
  // How fast each error falls without bias: squares as 1/N, absolute values as its root.
  const SLOPES = { mse: -1, relmse: -1, relmse_trimmed: -1, mape: -0.5, smape: -0.5 };

  function errorSection() {
    const metrics = report.metrics.filter((m) => configurations.some((c) => c.curve.some((p) => known(p[m.name]))));
    const axes = AXES.filter((a) => configurations.some((c) => c.curve.some((p) => known(a.of(p)) && a.of(p) > 0)));
    if (!metrics.length || !axes.length) return null;
    let metric = metrics.find((m) => m.name === report.metric) || metrics[0];
    let axis = axes.find((a) => a.key === report.clock) || axes[0];

    const points = (c) => c.curve.filter((p) => known(p[metric.name]) && p[metric.name].mean > 0 && axis.of(p) > 0);
    const floorOf = () => (report.reference && report.reference.floor && report.reference.floor[metric.name]) || null;

    function traces() {
      const all = configurations.flatMap((c) => points(c).map((p) => ({ x: axis.of(p), e: p[metric.name] })));
      const xs = all.map((p) => p.x), means = all.map((p) => p.e.mean);
      const lowest = Math.min(...means) / 4; // of an error from which a floor was subtracted, the low end can be under zero
      const bottom = Math.min(...all.map((p) => Math.max(p.e.low, lowest)));
      const top = Math.max(...all.map((p) => p.e.high));
      const x = [Math.min(...xs), Math.max(...xs)];
      const list = [];
      for (const c of configurations) {
        const of = points(c);
        if (!of.length) continue;
        const colour = colourOf(c), low = of.map((p) => Math.max(p[metric.name].low, bottom / 2)), high = of.map((p) => p[metric.name].high);
        const px = of.map(axis.of);
        list.push({
          uid: `band-${uidOf(c)}`, legendgroup: c.name, showlegend: false, hoverinfo: "skip", type: "scatter", mode: "lines",
          x: [...px, ...[...px].reverse()], y: [...high, ...low.reverse()], fill: "toself", fillcolor: alpha(colour, 0.18), line: { width: 0, color: colour },
        });
      }
      for (const c of configurations) {
        const of = points(c);
        if (!of.length) continue;
        const colour = colourOf(c), style = styleOf(c);
        list.push({
          uid: `line-${uidOf(c)}`, legendgroup: c.name, name: safe(isNarrow() ? short(c.name, 34) : c.name), type: "scatter", mode: "lines+markers",
          x: of.map(axis.of), y: of.map((p) => p[metric.name].mean),
          line: { color: colour, width: 2, dash: style.dash },
          marker: { size: 8, color: colour, symbol: of.map((p) => (p.near_floor ? `${style.marker}-open` : style.marker)), line: { width: 1.6, color: colour } },
          text: of.map((p) => [`<b>${safe(c.name)}</b>, ${p.spp} spp`, `${safe(metric.label)} ${intervalText(p[metric.name])}`, axis.text(p), p.near_floor ? "under ten times the reference’s floor" : null].filter(known).join("<br>")),
          hovertemplate: "%{text}<extra></extra>",
        });
      }
      const floor = floorOf();
      const span = [x[0] / 1000, x[1] * 1000];
      if (floor) {
        list.push({ uid: "floor-shade", legendgroup: "floor", showlegend: false, hoverinfo: "skip", type: "scatter", mode: "lines", x: [...span, span[1], span[0]], y: [floor, floor, 10 * floor, 10 * floor], fill: "toself", fillcolor: alpha(css("--soft"), 0.13), line: { width: 0 } });
        list.push({ uid: "floor", legendgroup: "floor", name: "error of the reference, and ten times it", type: "scatter", mode: "lines", x: span, y: [floor, floor], line: { color: css("--soft"), width: 1.5, dash: "2px,3px" }, hovertemplate: `error of the reference: ${number(floor)}<extra></extra>` });
      }
      const slope = SLOPES[metric.name];
      if (slope && x[1] > x[0]) {
        const k = 0.6 * Math.min(...all.map((p) => p.e.mean * p.x ** -slope));
        list.push({ uid: "guide", name: slope === -1 ? "slope −1" : "slope −½", hoverinfo: "skip", type: "scatter", mode: "lines", x, y: x.map((t) => k * t ** slope), line: { color: css("--soft"), width: 1 } });
      }
      const log = Math.log10;
      const range = [log(Math.min(bottom, 0.6 * Math.min(...means), floor && floor > bottom / 30 ? floor : Infinity)) - 0.1, log(top) + 0.1];
      return { list, x: [log(x[0]) - 0.12, log(x[1]) + 0.12], y: range };
    }

    const curves = plot("curves", "error of each configuration against time, both logarithmic", () => `${metric.name}-${axis.key}`, (place) => {
      place.style.height = isNarrow() ? `${420 + 20 * (configurations.length + 2)}px` : ""; // the legend has a line for each
      const { list, x, y } = traces();
      // Within two decades 1, 2 and 5 are marked, written out: by itself Plotly drops their zeros.
      const ticks = (r) => (r[1] - r[0] > 2.2 ? { dtick: 1, exponentformat: r[0] > -2.5 && r[1] < 3.5 ? "none" : "power" } : { dtick: "D2", tickformat: "~g" });
      return { traces: list, layout: {
        uirevision: "legend", legend: { orientation: "h", x: 0, y: isNarrow() ? -0.17 : -0.15, yanchor: "top", font: { size: 13 } },
        xaxis: { type: "log", range: x, uirevision: axis.key, title: { text: axis.title, standoff: 8 }, ...ticks(x) },
        yaxis: { type: "log", range: y, uirevision: metric.name, title: { text: safe(metric.label), standoff: 8 }, ...ticks(y) },
      } };
    });

    const missing = h("p", { class: "note", "aria-live": "polite" });
    function update() {
      curves.draw();
      const out = configurations.filter((c) => !points(c).length && !c.curve.some((p) => known(p[metric.name]) && axis.of(p) > 0)).map((c) => c.name);
      const lower = configurations.filter((c) => c.curve.some((p) => known(p[metric.name]) && p[metric.name].mean <= 0)).map((c) => c.name);
      missing.textContent = [
        out.length ? `Not drawn, because not known here: ${out.join(", ")}.` : "",
        lower.length ? `Some points of ${lower.join(", ")} are not drawn: less the reference’s floor, nothing is left of their error.` : "",
      ].join(" ").trim();
    }
    plots.push(update);
    plots.splice(plots.indexOf(curves.draw), 1);

    const select = (name, list, key, text, change) =>
      h("label", {}, name, h("select", { name: name.toLowerCase().replace(/\W+/g, "-"), onchange: (e) => { change(list.find((o) => o[key] === e.target.value)); update(); } },
        list.map((o) => h("option", { value: o[key], selected: o === metric || o === axis }, text(o)))));

    const hollow = configurations.some((c) => c.curve.some((p) => p.near_floor));
    const notes = configurations.filter((c) => filled(c.notes)).map((c) => h("li", {}, `${c.name}: ${c.notes.join("; ")}.`.replace(/\.\.$/, ".")));
    return section("error", "Error against time",
      read(`Lower and further left is better: each line is the mean over the seeds at one checkpoint after the other, its band the 95 % interval.${
        hollow ? " Hollow points lie under ten times the reference’s own error, where no comparison should be trusted." : ""} A click on a name hides it, a double click leaves it alone; the camera saves the figure as SVG.`),
      h("div", { class: "controls" },
        select("Error", metrics, "name", (m) => m.label, (m) => (metric = m)),
        select("Against", axes, "key", (a) => a.name, (a) => (axis = a))),
      curves.place, missing, notes.length ? h("ul", { class: "note" }, notes) : null);
  }

  // ---- 3. Time to the target -----------------------------------------------------------------------------------------

  // Dots with intervals on a logarithmic axis of ratios, one line each.
  function forest(title, label, what, rows) {
    if (!rows.length) return null;
    const { place } = plot("forest", label, what, () => {
      const values = rows.flatMap(({ i }) => [i.low, i.high, i.mean]).filter((x) => x > 0);
      const edge = Math.max(1.3, ...values.map((x) => Math.max(x, 1 / x))) * 1.06;
      const low = Math.min(...values) < 0.97 ? Math.min(...values) / 1.1 : 1 / 1.15;
      const high = Math.max(...values) > 1.03 ? Math.max(...values) * 1.1 : 1.15;
      const ticks = edge < 2.4 ? [0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.2, 1.4, 1.6, 1.8, 2] : edge < 12 ? [0.1, 0.2, 0.5, 1, 2, 5, 10] : [1e-4, 1e-3, 0.01, 0.1, 1, 10, 100, 1e3, 1e4];
      const traces = rows.map(({ c, i }, n) => {
        const colour = isTie(i) ? css("--soft") : colourOf(c);
        return {
          type: "scatter", mode: "markers", x: [i.mean], y: [n], showlegend: false,
          marker: { symbol: styleOf(c).marker, size: 11, color: colour },
          error_x: { type: "data", symmetric: false, array: [i.high - i.mean], arrayminus: [i.mean - i.low], color: colour, thickness: 2, width: 5 },
          text: [`<b>${safe(c.name)}</b><br>${intervalText(i)}${isTie(i) ? ", tie" : ""}`], hovertemplate: "%{text}<extra></extra>",
        };
      });
      return { traces, layout: {
        height: 70 + 40 * rows.length, margin: { l: isNarrow() ? 106 : 126, r: 14, t: 36, b: 34 },
        xaxis: { type: "log", range: [Math.log10(low), Math.log10(high)], tickvals: ticks, ticktext: ticks.map(String), tickangle: 0, fixedrange: true },
        yaxis: { tickvals: rows.map((_, n) => n), ticktext: rows.map(({ c, i }) => safe(short(c.name, 16)) + (isTie(i) ? "<br>tie" : "")), range: [rows.length - 0.5, -0.5], fixedrange: true, ticks: "", showgrid: false },
        shapes: [{ type: "line", x0: 1, x1: 1, yref: "paper", y0: 0, y1: 1, line: { color: css("--ink"), width: 1 } }],
        annotations: [{ xref: "paper", yref: "paper", x: 0, y: 1, yshift: 20, xanchor: "left", text: "← better than the baseline", showarrow: false, font: { color: css("--soft"), size: 12 } }],
      } };
    });
    return h("div", {}, h("h4", {}, title), place);
  }

  const metricLabel = (name) => (report.metrics.find((m) => m.name === name) || { label: name }).label.replace(" %", "\u00a0%");

  function targetSection() {
    const with_ = configurations.filter((c) => c.time_to_target || c.efficiency);
    if (!with_.length) return null;
    const first = with_.find((c) => c.time_to_target && known(c.time_to_target.target));
    const target = first && first.time_to_target.target;
    const verdict = (c) => {
      const t = c.time_to_target;
      if (!t) return kNone;
      return t.verdict === "tie" ? h("span", { class: "tie" }, "tie") : t.verdict;
    };
    const time = (c) => {
      const t = c.time_to_target;
      if (!t || !t.ratio || c === baseline) return kNone;
      return t.verdict === "tie" ? h("span", { class: "tie" }, interval(t.ratio)) : interval(t.ratio);
    };
    const rows = with_.map((c) => [
      namedBriefly(c), c.time_to_target && c.time_to_target.seconds ? interval(c.time_to_target.seconds) : kNone, time(c), verdict(c),
      c.efficiency ? interval(c.efficiency.variance_x_seconds) : kNone,
      c === baseline && c.efficiency && configurations.length > 1 ? "baseline" : c.efficiency ? ratio(c.efficiency.ratio) : kNone,
    ]);
    const others = (of) => with_.filter((c) => c !== baseline && of(c)).map((c) => ({ c, i: of(c) }));
    const timeRows = others((c) => c.time_to_target && c.time_to_target.ratio);
    const efficiencyRows = others((c) => c.efficiency && c.efficiency.ratio);
    return section("target", "Who reaches the target",
      first ? read(`The target is ${metricLabel(report.metric)} ≤ ${brief(target)}. Ratios are to the ${clock} time of ${baseline.name} with seeds paired: 0.5 means half the time.${report.clock === "cpu" ? " Processor time is taken, since the wall times of equal runs scattered too much on this machine." : ""} ${product} × time compares the same without a target.`) : read(`${product} × time: the smaller, the sooner any quality is reached.`),
      table("time to the target", [["Configuration"], ["Seconds to target", "number"], ["Ratio of times", "number"], ["Verdict", "word-column"], [`${product} × ${effort} seconds`, "number"], ["Ratio", "number"]], rows),
      timeRows.length || efficiencyRows.length ? [
        h("h3", {}, "The ratios drawn"),
        read("Dots are estimates, bars 95 % intervals. A bar that crosses the line at 1 is a tie, drawn grey."),
        h("div", { class: "pair" },
          forest(`Time to the target, over that of ${baseline.name}`, "ratios of the times to the target", "time-to-target", timeRows),
          forest(`${product} × ${effort} seconds, over those of ${baseline.name}`, "ratios of variance times seconds", "efficiency", efficiencyRows)),
      ] : null);
  }

  // ---- 4. Equal time, equal samples ----------------------------------------------------------------------------------

  function equalSection() {
    const one = (field, title, says, at) => {
      const of = configurations.filter((c) => c[field]);
      if (!of.length) return null;
      return h("div", {}, h("h3", {}, title(of[0][field])), read(says),
        table(title(of[0][field]), [["Configuration"], [at[0], "number"], [metricLabel(report.metric), "number"], ["Ratio", "number"]],
          of.map((c) => [namedBriefly(c), at[1](c[field], of[0][field]), interval(c[field].error), c === baseline ? "baseline" : ratio(c[field].ratio)])));
    };
    const apart = configurations.filter((c) => c.pilot_apart > 0).map((c) => ` The pilot of ${c.name}, ${brief(c.pilot_apart)} camera samples per pixel more, is not in its image; its time and rays count.`).join("");
    // where the metric leaves pixels out, the same with all of them
    const all = configurations.filter((c) => c.all_pixels);
    const whole = all.length ? h("div", {}, h("h3", {}, "With all pixels"),
      read(`The same by relMSE, with the largest 0.1 % of the pixels in it: the time to ${brief(all[0].all_pixels.time_to_target.target)}, and the errors at equal time and equal samples, as ratios to those of ${baseline.name}. The rare large samples make these intervals wide, and rough.`),
      table("with all pixels", [["Configuration"], ["Seconds to target", "number"], ["Ratio of times", "number"], ["At equal time", "number"], ["At equal samples", "number"], ["Variance × CPU seconds, ratio", "number"]],
        all.map((c) => {
          const a = c.all_pixels, of = (part) => (c === baseline ? kNone : part ? ratio(part.ratio) : kNone);
          return [named(c), a.time_to_target.seconds ? interval(a.time_to_target.seconds) : a.time_to_target.verdict, of(a.time_to_target), of(a.equal_time), of(a.equal_samples), of(a.efficiency)];
        }), "dense")) : null;
    const parts = [
      one("equal_time", (e) => `At ${number(e.seconds)} s`, `Errors read from the curves at the same ${clock} time, and their ratios to the baseline’s: under 1 is better.`, ["s", (e, first) => (e.seconds === first.seconds ? kNone : number(e.seconds))]),
      one("equal_samples", (e) => `At ${integer(e.spp)} samples per pixel`, `Errors at the same number of samples in the image, whatever they cost, and their ratios to the baseline’s.${apart}`, ["spp", (e, first) => (e.spp === first.spp ? kNone : integer(e.spp))]),
    ].filter(known);
    return parts.length ? section("equal", "At equal time, and at equal samples", h("div", { class: parts.length > 1 ? "pair" : null }, parts), whole) : null;
  }

  // ---- 5. Images -----------------------------------------------------------------------------------------------------

  // A PNG as it was packed: 8 bit, RGB, RGBA or grey, not interlaced. Decoded here, for a browser may colour-manage what it
  // decodes, or blur what is read back from a canvas.
  async function decodePng(base64) {
    const bytes = Uint8Array.from(atob(base64.trim()), (c) => c.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    let width = 0, height = 0, channels = 0;
    const packed = [];
    for (let at = 8; at < bytes.length;) {
      const length = view.getUint32(at), type = String.fromCharCode(...bytes.subarray(at + 4, at + 8)), data = at + 8;
      if (type === "IHDR") {
        width = view.getUint32(data);
        height = view.getUint32(data + 4);
        channels = { 0: 1, 2: 3, 4: 2, 6: 4 }[bytes[data + 9]];
        if (bytes[data + 8] !== 8 || bytes[data + 12] !== 0 || !channels) throw new Error("not the kind of PNG that the report has");
      } else if (type === "IDAT") packed.push(bytes.subarray(data, data + length));
      at = data + length + 4;
    }
    const stream = new Blob(packed).stream().pipeThrough(new DecompressionStream("deflate"));
    const lines = new Uint8Array(await new Response(stream).arrayBuffer());
    const stride = width * channels, out = new Uint8Array(stride * height);
    for (let y = 0, from = 0, to = 0; y < height; ++y) {
      const filter = lines[from++], up = to - stride;
      for (let x = 0; x < stride; ++x, ++from, ++to) {
        const a = x >= channels ? out[to - channels] : 0;
        const b = y > 0 ? out[up + x] : 0;
        let predicted = 0;
        if (filter === 1) predicted = a;
        else if (filter === 2) predicted = b;
        else if (filter === 3) predicted = (a + b) >> 1;
        else if (filter === 4) {
          const c = x >= channels && y > 0 ? out[up + x - channels] : 0;
          const pa = Math.abs(b - c), pb = Math.abs(a - c), pc = Math.abs(a + b - 2 * c);
          predicted = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
        }
        out[to] = lines[from] + predicted;
      }
    }
    const grey = channels < 3;
    return { width, height, at: (x, y, c) => out[(y * width + x) * channels + (grey ? 0 : c)] };
  }

  // matplotlib's inferno at tenths of its length; between them lines are near enough.
  const INFERNO = ["#000004", "#160b39", "#420a68", "#6a176e", "#932667", "#bc3754", "#dd513a", "#f37819", "#fca50a", "#f6d746", "#fcffa4"];
  const infernoTable = (() => {
    const rgb = INFERNO.map((hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16)));
    const list = new Uint8Array(256 * 3);
    for (let i = 0; i < 256; ++i) {
      const t = (i / 255) * 10, k = Math.min(9, Math.floor(t));
      for (let c = 0; c < 3; ++c) list[3 * i + c] = Math.round(rgb[k][c] + (rgb[k + 1][c] - rgb[k][c]) * (t - k));
    }
    return list;
  })();

  const kNoValue = [90, 60, 110]; // where a map has no value
  const scalarValue = (image, q) => {
    const v = image.low + ((image.high - image.low) * q) / 65534;
    return image.log ? 10 ** v : v;
  };

  // What radiance looks like on the screen: sRGB of mantissa m and exponent e, as table[256 e + m].
  function radianceTable(exposure) {
    const list = new Uint8Array(65536);
    for (let e = 0; e < 256; ++e) {
      const scale = 2 ** (e - 136 + exposure);
      for (let m = 0; m < 256; ++m) {
        const x = Math.min(1, m * scale);
        list[256 * e + m] = Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
      }
    }
    return list;
  }

  const classColours = (image) => (image.classes || []).map((k) => [1, 3, 5].map((i) => parseInt(k.colour.slice(i, i + 2), 16)));

  // The picture of a decoded image as ImageData.
  function develop(image, png, exposure) {
    const { width, height } = image, data = new ImageData(width, height), to = data.data;
    const put = (i, r, g, b) => { to[i] = r; to[i + 1] = g; to[i + 2] = b; to[i + 3] = 255; };
    const tone = image.kind === "radiance" ? radianceTable(exposure) : null;
    const colours = image.kind === "classes" ? classColours(image) : null;
    for (let y = 0, i = 0; y < height; ++y)
      for (let x = 0; x < width; ++x, i += 4) {
        if (tone) {
          const e = 256 * png.at(x, y + height, 0);
          put(i, tone[e + png.at(x, y, 0)], tone[e + png.at(x, y, 1)], tone[e + png.at(x, y, 2)]);
        } else if (image.kind === "scalar") {
          if (png.at(x, y, 2) === 255) put(i, ...kNoValue);
          else {
            const k = 3 * Math.round(((256 * png.at(x, y, 0) + png.at(x, y, 1)) / 65534) * 255);
            put(i, infernoTable[k], infernoTable[k + 1], infernoTable[k + 2]);
          }
        } else if (image.kind === "classes") put(i, ...(colours[png.at(x, y, 0)] || [128, 128, 128]));
        else put(i, png.at(x, y, 0), png.at(x, y, 1), png.at(x, y, 2));
      }
    return data;
  }

  function pixelText(image, png, x, y) {
    const where = `x ${x}, y ${y}:  `;
    if (image.kind === "radiance") {
      const scale = 2 ** (png.at(x, y + image.height, 0) - 136);
      return where + [0, 1, 2].map((c) => `${"RGB"[c]} ${number(png.at(x, y, c) * scale)}`).join("   ");
    }
    if (image.kind === "scalar") return where + (png.at(x, y, 2) === 255 ? "no value" : number(scalarValue(image, 256 * png.at(x, y, 0) + png.at(x, y, 1))));
    if (image.kind === "classes") {
      const found = (image.classes || [])[png.at(x, y, 0)];
      return where + (found ? found.name : "none");
    }
    const names = image.group === "allocation" ? ["lobes", "cosine", "light"] : ["R", "G", "B"];
    return where + names.map((name, c) => `${name} ${percent(png.at(x, y, c) / 255)}`).join("   ");
  }

  const GROUPS = [["image", "images"], ["error", "errors"], ["allocation", "allocation"], ["ways", "ways"], ["map", "maps"]];

  function viewerSection() {
    if (!filled(report.images)) return null;
    const images = report.images.map((image, i) => ({ ...image, i, png: null }));
    const groups = GROUPS.filter(([key]) => images.some((image) => image.group === key));
    const view = { zoom: 1, x: 0.5, y: 0.5, exposure: 0 };
    let group = groups.length ? groups[0][0] : "all";
    let current = images.find((image) => group === "all" || image.group === group) || images[0];
    let pointer = null; // the image's pixel that is told of
    const listed = () => images.filter((image) => group === "all" || image.group === group);

    const canvas = h("canvas", { class: "main", tabindex: 0, role: "img" });
    const developed = document.createElement("canvas"); // the current image at its own size
    let developedAs = "";
    const name = h("strong", { "aria-live": "polite" }), pixel = h("span", { class: "pixel" }), text = h("p", { class: "text" });
    const legend = h("div", { class: "legend" }), thumbs = h("div", { class: "thumbs", role: "group", "aria-label": "choose an image" });
    const exposureText = h("output", {});
    const slider = h("input", { type: "range", min: -10, max: 10, step: 0.25, value: 0, "aria-label": "exposure in stops", oninput: () => expose(Number(slider.value)) });

    async function load(image) {
      if (!image.png) image.png = decodePng(document.getElementById(`image-${image.i}`).textContent).then((png) => { image.decoded = png; });
      await image.png;
    }

    const fit = () => Math.min(canvas.width / current.width, canvas.height / current.height);

    function clamp() {
      const keep = (at, size, of) => { const half = of / (2 * size * fit() * view.zoom); return half >= 0.5 ? 0.5 : Math.min(1 - half, Math.max(half, at)); };
      view.x = keep(view.x, current.width, canvas.width);
      view.y = keep(view.y, current.height, canvas.height);
    }

    function draw() {
      const box = canvas.clientWidth;
      if (!box) return;
      const shape = Math.min(current.height / current.width, Math.max(240, 0.78 * window.innerHeight) / box);
      const density = window.devicePixelRatio || 1;
      const width = Math.round(box * density), height = Math.round(box * shape * density);
      if (canvas.width !== width || canvas.height !== height) {
        canvas.width = width;
        canvas.height = height;
      }
      clamp();
      const context = canvas.getContext("2d");
      context.fillStyle = "#101114";
      context.fillRect(0, 0, width, height);
      canvas.classList.toggle("zoomed", view.zoom > 1);
      Object.assign(canvas.dataset, { image: current.key, zoom: view.zoom.toFixed(4), x: view.x.toFixed(5), y: view.y.toFixed(5), exposure: view.exposure, drawn: current.decoded ? "true" : "false" });
      if (!current.decoded) return;
      const as = `${current.i} ${current.kind === "radiance" ? view.exposure : ""}`;
      if (developedAs !== as) {
        developed.width = current.width;
        developed.height = current.height;
        developed.getContext("2d").putImageData(develop(current, current.decoded, view.exposure), 0, 0);
        developedAs = as;
      }
      const scale = fit() * view.zoom;
      context.imageSmoothingEnabled = false;
      context.drawImage(developed, width / 2 - view.x * current.width * scale, height / 2 - view.y * current.height * scale, current.width * scale, current.height * scale);
      tell();
    }

    let asked = false;
    function redraw() {
      if (!asked) requestAnimationFrame(() => { asked = false; draw(); });
      asked = true;
    }

    function tell() {
      const inside = pointer && current.decoded && pointer.x >= 0 && pointer.y >= 0 && pointer.x < 1 && pointer.y < 1;
      pixel.textContent = inside ? pixelText(current, current.decoded, Math.floor(pointer.x * current.width), Math.floor(pointer.y * current.height)) : "";
    }

    function describe() {
      name.textContent = current.label;
      text.textContent = current.text || "";
      canvas.setAttribute("aria-label", `${current.label}. ${current.text || ""}`);
      legend.replaceChildren(...[legendOf(current)].filter(known));
      slider.disabled = current.kind !== "radiance";
      for (const button of thumbs.children) button.setAttribute("aria-pressed", String(Number(button.dataset.index) === current.i));
    }

    function legendOf(image) {
      if (image.kind === "scalar") {
        const ends = image.log ? [10 ** image.low, 10 ** ((image.low + image.high) / 2), 10 ** image.high] : [image.low, (image.low + image.high) / 2, image.high];
        return h("div", { class: "scale" }, h("div", { class: "bar", style: `background:linear-gradient(90deg,${INFERNO.join(",")})` }),
          h("div", { class: "ends" }, ends.map((x) => h("span", {}, number(x)))));
      }
      const entries = image.kind === "classes" ? (image.classes || []).map((k) => [k.name, k.colour])
        : image.kind === "rgb" && image.group === "allocation" ? [["lobes", "#f00"], ["cosine", "#0f0"], ["light", "#00f"]] : [];
      return entries.length ? h("div", { class: "key" }, entries.map(([label, colour]) => h("span", {}, h("i", { style: `background:${colour}` }), label))) : null;
    }

    async function show(image) {
      current = image;
      describe();
      redraw();
      try {
        await load(image);
      } catch (error) {
        text.textContent = `This browser cannot show the image: ${error.message}.`;
      }
      if (image === current) redraw();
    }

    function step(by) {
      const list = listed();
      show(list[(list.indexOf(current) + by + list.length) % list.length]);
    }

    function expose(stops) {
      view.exposure = Math.min(10, Math.max(-10, stops));
      slider.value = view.exposure;
      exposureText.textContent = `${view.exposure > 0 ? "+" : ""}${minus(view.exposure)} EV`;
      redraw();
    }

    // Zooms about a point of the canvas, given in its pixels.
    function zoom(factor, px = canvas.width / 2, py = canvas.height / 2) {
      const before = fit() * view.zoom;
      const ix = view.x + (px - canvas.width / 2) / (current.width * before), iy = view.y + (py - canvas.height / 2) / (current.height * before);
      view.zoom = Math.min(64, Math.max(1, view.zoom * factor));
      const after = fit() * view.zoom;
      view.x = ix - (px - canvas.width / 2) / (current.width * after);
      view.y = iy - (py - canvas.height / 2) / (current.height * after);
      redraw();
    }

    function reset() {
      Object.assign(view, { zoom: 1, x: 0.5, y: 0.5 });
      expose(0);
    }

    function listThumbs() {
      thumbs.replaceChildren(...listed().map((image, n) => {
        const small = h("canvas", { width: 192, height: 128, "aria-hidden": "true" });
        paintThumb(image, small);
        return h("button", { type: "button", "data-index": image.i, "aria-pressed": "false", onclick: () => show(image) },
          small, h("span", {}, n < 9 ? h("kbd", {}, String(n + 1)) : null, image.label));
      }));
    }

    async function paintThumb(image, small) {
      await load(image).catch(() => {});
      if (!image.decoded) return;
      const full = document.createElement("canvas");
      full.width = image.width;
      full.height = image.height;
      full.getContext("2d").putImageData(develop(image, image.decoded, 0), 0, 0);
      const scale = Math.min(small.width / image.width, small.height / image.height);
      const context = small.getContext("2d");
      context.imageSmoothingQuality = "high";
      context.drawImage(full, (small.width - image.width * scale) / 2, (small.height - image.height * scale) / 2, image.width * scale, image.height * scale);
    }

    function setGroup(key) {
      group = key;
      listThumbs();
      legend.classList.toggle("kept", listed().some(legendOf)); // so that nothing moves on a flip
      // The same configuration's image of the other group, where it has one.
      const list = listed();
      show(list.find((image) => image === current) || list.find((image) => current.configuration && image.configuration === current.configuration) || list[0]);
    }

    // Pointers: one drags, two pinch.
    const down = new Map();
    const toCanvas = (event) => {
      const box = canvas.getBoundingClientRect();
      return { x: ((event.clientX - box.left) / box.width) * canvas.width, y: ((event.clientY - box.top) / box.height) * canvas.height };
    };
    const point = (event) => {
      const p = toCanvas(event), scale = fit() * view.zoom;
      pointer = { x: view.x + (p.x - canvas.width / 2) / (current.width * scale), y: view.y + (p.y - canvas.height / 2) / (current.height * scale) };
      tell();
    };
    const spread = () => {
      const [a, b] = [...down.values()];
      return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.max(1, Math.hypot(a.x - b.x, a.y - b.y)) };
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      down.set(event.pointerId, toCanvas(event));
      point(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (down.has(event.pointerId)) {
        const before = down.size === 2 ? spread() : down.get(event.pointerId);
        down.set(event.pointerId, toCanvas(event));
        const after = down.size === 2 ? spread() : down.get(event.pointerId);
        if (down.size <= 2) {
          const scale = fit() * view.zoom;
          view.x -= (after.x - before.x) / (current.width * scale);
          view.y -= (after.y - before.y) / (current.height * scale);
          if (down.size === 2) zoom(after.size / before.size, after.x, after.y);
          redraw();
        }
      }
      point(event);
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => down.delete(event.pointerId));
    canvas.addEventListener("pointerleave", (event) => {
      if (event.pointerType !== "mouse") return;
      pointer = null;
      tell();
    });
    // The wheel zooms an image that was clicked; before, it moves the page as everywhere.
    canvas.addEventListener("wheel", (event) => {
      if (!(event.ctrlKey || event.metaKey || document.activeElement === canvas)) return;
      event.preventDefault();
      const p = toCanvas(event);
      zoom(2 ** (-event.deltaY * (event.deltaMode === 1 ? 0.06 : 0.003)), p.x, p.y);
    }, { passive: false });

    const viewer = h("div", { class: "viewer" },
      h("div", { class: "controls" },
        groups.length > 1 ? h("label", {}, "Show", h("select", { name: "group", onchange: (e) => setGroup(e.target.value) },
          [...groups, ["all", "everything"]].map(([key, label]) => h("option", { value: key, selected: key === group }, label)))) : null,
        h("span", {}, h("button", { type: "button", "aria-label": "previous image", onclick: () => step(-1) }, "←"), " ",
          h("button", { type: "button", "aria-label": "next image", onclick: () => step(1) }, "→")),
        h("span", {}, h("button", { type: "button", "aria-label": "zoom out", onclick: () => zoom(1 / 1.5) }, "−"), " ",
          h("button", { type: "button", "aria-label": "zoom in", onclick: () => zoom(1.5) }, "+"), " ",
          h("button", { type: "button", onclick: reset }, "Reset")),
        h("label", {}, "Exposure", slider, exposureText)),
      canvas,
      h("div", { class: "caption" }, name, pixel), text, legend, thumbs);

    // Keys reach the viewer where it, or nothing, has the focus and it can be seen.
    document.addEventListener("keydown", (event) => {
      const active = document.activeElement, inside = viewer.contains(active);
      if (event.ctrlKey || event.metaKey || event.altKey || (inside && /^(input|select)$/i.test(active.tagName))) return;
      if (!inside) {
        const box = canvas.getBoundingClientRect();
        if ((active && active !== document.body) || box.bottom < 40 || box.top > window.innerHeight - 40 || event.key === "Home") return;
      }
      const list = listed();
      if (/^[1-9]$/.test(event.key)) { if (list[event.key - 1]) show(list[event.key - 1]); }
      else if (event.key === "ArrowRight") step(1);
      else if (event.key === "ArrowLeft") step(-1);
      else if (event.key === "+" || event.key === "=") zoom(1.5);
      else if (event.key === "-") zoom(1 / 1.5);
      else if (event.key === "e") expose(view.exposure + 0.5);
      else if (event.key === "E") expose(view.exposure - 0.5);
      else if (event.key === "0" || event.key === "Home") reset();
      else return;
      event.preventDefault();
    });

    started.push(async () => {
      expose(0);
      setGroup(group);
      new ResizeObserver(redraw).observe(canvas);
      for (const image of images) await load(image).catch(() => {}); // so that flipping waits for nothing
      viewer.dataset.ready = "true";
    });

    return section("images", "Images",
      read("All images share one view: what you zoom into stays where it is when you flip, so that differences jump out. Exposure brightens the renders alone; errors and maps keep their scale."),
      viewer,
      h("p", { class: "note keys" }, h("kbd", {}, "1"), "–", h("kbd", {}, "9"), " choose, ", h("kbd", {}, "←"), " ", h("kbd", {}, "→"), " flip, drag to move, click and wheel or ",
        h("kbd", {}, "+"), " ", h("kbd", {}, "−"), " to zoom, ", h("kbd", {}, "e"), " brighter, ", h("kbd", {}, "E"), " darker, ", h("kbd", {}, "0"), " resets."));
  }
  const started = []; // what waits until the page stands

  // ---- 6. Slope, bias, tail ------------------------------------------------------------------------------------------

  function biasSection() {
    const of = configurations.filter((c) => c.slope || c.bias || c.tail);
    if (!of.length) return null;
    const flagged = (text, isFlag) => (isFlag ? h("span", { class: "flag" }, text) : text);
    const slopeOf = (s) => (s ? interval({ mean: s.value, low: s.low, high: s.high }) : kNone);
    const flagOf = (s) => (!s ? kNone : s.flag === "none" ? "none" : flagged(s.cause && s.cause !== "none" ? `${s.flag}: ${s.cause}` : s.flag, true));
    const slopes = of.map((c) => [
      named(c), slopeOf(c.slope), c.slope && known(c.slope.from_spp) ? integer(c.slope.from_spp) : kNone, flagOf(c.slope),
      c.tail ? flagged(percent(c.tail.top_share), c.tail.heavy) : kNone, c.tail ? flagged(number(c.tail.seed_ratio), c.tail.heavy) : kNone,
    ]);
    const judged = of.filter((c) => c.bias), blocks = judged.find((c) => known(c.bias.block));
    const tested = (c, text) => (c.bias.tested ? text(c.bias) : kNone);
    const biases = judged.map((c) => [
      named(c), flagged(c.bias.verdict, c.bias.verdict === "biased"), tested(c, (b) => `${integer(b.failed_blocks)} of ${integer(b.blocks)}`), tested(c, (b) => (b.unmet_blocks > 0 ? integer(b.unmet_blocks) : kNone)),
      tested(c, (b) => number(b.smallest_p)), tested(c, (b) => number(b.threshold)), tested(c, (b) => number(b.image_z)),
    ]);
    return section("slope", "Slope and bias",
      read("Without bias the squared error falls as 1/N, a slope of −1. A shallower line means bias, or a heavy tail (rare, very bright samples, seen in the worst pixels’ share of the error and in single seeds far off the others), or an allocation that does worse than its pilot."),
      table("slope", [["Configuration"], ["Slope", "number"], ["From spp", "number"], ["Flag: cause", "word-column"], ["Error in the worst 0.1 % of pixels", "number"], ["Largest / median error of a seed", "number"]], slopes),
      judged.length ? [
        read(`Bias is the mean over the seeds against the reference, tested in ${blocks ? `blocks of ${blocks.bias.block} × ${blocks.bias.block} pixels` : "blocks of pixels"}. A block fails where its p is under the threshold, which allows for their number; those that are no darker than so few samples of the reference could be may have missed a rare light by chance, and do not count. z is that of the whole image.`),
        table("bias", [["Configuration"], ["Bias", "word-column"], ["Blocks failed", "number"], ["Of these by chance, maybe", "number"], ["Smallest p", "number"], ["Threshold", "number"], ["z of the image", "number"]], biases),
      ] : null,
      words(of.map((c) => [c, [c.slope && c.slope.text, c.bias && c.bias.text]])));
  }

  // ---- 7. Where does it help -----------------------------------------------------------------------------------------

  const KINDS = [["object", "By object"], ["material", "By material"], ["stiffness", "By stiffness"]];

  // Blue below one, orange above it, deeper with distance; ties stay bare.
  function heat(i) {
    if (!known(i) || !(i.mean > 0)) return kNone;
    if (isTie(i)) return { is: ratio(i), class: "ratio" };
    const depth = Math.min(1, Math.abs(Math.log2(i.mean)) / 1.5);
    return { is: interval(i), class: "ratio", style: `background:rgba(var(--${i.mean < 1 ? "better" : "worse"}),${(0.1 + 0.32 * depth).toFixed(3)})` };
  }

  function whereSection() {
    const winners = configurations.filter((c) => c.wins && c !== baseline);
    const looks = { better: `rgba(var(--better),0.8)`, worse: `rgba(var(--worse),0.8)`, undecided: `rgba(128,128,128,0.25)` };
    const wins = winners.length ? [
      h("h3", {}, `Pixels that gain and lose against ${baseline.name}`),
      read(`relMSE × ${effort} time in blocks of 4 × 4 pixels, counted only where the difference is significant (Benjamini–Hochberg at 5 %).${
        (report.images || []).some((image) => image.kind === "classes") ? " Where these pixels are is shown by the maps among the images." : ""}`),
      table("pixels that gain and lose", [["Configuration"], ["Better", "number"], ["Worse", "number"], ["Undecided", "number"], [""]],
        winners.map((c) => [named(c), percent(c.wins.better), percent(c.wins.worse), percent(c.wins.undecided),
          { is: shareBar(["better", "undecided", "worse"].map((k) => [k, c.wins[k] || 0, looks[k]])), class: "bare" }])),
      h("div", { class: "key" }, ["better", "undecided", "worse"].map((k) => h("span", {}, h("i", { style: `background:${looks[k]}` }), k))),
      winners.filter((c) => c.wins.text).map((c) => read(c.wins.text)),
    ] : null;
    const tables = KINDS.map(([kind, title]) => {
      const with_ = configurations.filter((c) => (c.groups || []).some((g) => g.kind === kind));
      if (!with_.length) return null;
      const names = [...new Set(with_.flatMap((c) => c.groups.filter((g) => g.kind === kind).map((g) => g.name)))];
      const find = (c, name) => c.groups.find((g) => g.kind === kind && g.name === name);
      const pixels = (name) => Math.max(...with_.map((c) => (find(c, name) || { pixels: 0 }).pixels || 0));
      const others = with_.filter((c) => c !== baseline);
      const first = with_.includes(baseline);
      const columns = [["Group"], ["Pixels", "number"], ...(first ? [[`${baseline.name}: ${metricLabel("relmse")}`, "number"]] : []), ...others.map((c) => [c.name, "number"])];
      const rows = names.map((name) => [name, integer(pixels(name)), ...(first ? [find(baseline, name) ? interval(find(baseline, name).relmse) : kNone] : []),
        ...others.map((c) => { const g = find(c, name); return !g ? kNone : known(g.ratio) ? heat(g.ratio) : first ? kNone : interval(g.relmse); })]);
      return [h("h3", {}, title), table(title, columns, rows, "heat")];
    });
    const groups = tables.some(known) ? [
      h("h3", {}, "Parts of the image"),
      read(`The ratio of each part’s relMSE × ${effort} time to that of ${baseline.name} in the same part: blue is less, orange is more, and a tie is left without colour.`),
      tables,
    ] : null;
    return section("where", "Where does it help", wins, groups);
  }

  // ---- 8. Cost -------------------------------------------------------------------------------------------------------

  function costSection() {
    const of = configurations.filter((c) => c.cost);
    const sum = (o) => (o ? Object.values(o).reduce((a, b) => a + (b || 0), 0) : null);
    const split = (o) => (o && sum(o) > 0 ? Object.entries(o).map(([k, v]) => `${k} ${percent(v / sum(o))}`).join(", ") : kNone);
    const total = of.length ? [
      h("h3", {}, "By allocation"),
      read("A gain can come from less variance or from cheaper samples; variance × cost is what both leave. Compare the columns with those of the baseline to see which it was. Pilot: wall seconds of a run that went to the samples from which its counts follow; they are part of its time."),
      table("cost by allocation", [["Configuration"], ["ns a sample", "number"], ["Rays a path", "number"], ["Evaluations", "number"], ["Samples", "number"], ["Rays", "number"], ["Pilot, s", "number"], [`${product} × CPU s`, "number"], [`${product} × rays`, "number"]],
        of.map((c) => [named(c), number(c.cost.ns_per_sample), number(c.cost.rays_per_path), known(c.cost.evaluations) ? integer(c.cost.evaluations) : kNone,
          known(sum(c.cost.samples)) ? integer(sum(c.cost.samples)) : kNone, known(sum(c.cost.rays)) ? integer(sum(c.cost.rays)) : kNone, number(c.pilot_seconds),
          c.efficiency ? interval(c.efficiency.variance_x_seconds) : kNone, c.efficiency && c.efficiency.variance_x_rays ? interval(c.efficiency.variance_x_rays) : kNone])),
      h("h3", {}, "What was sampled and traced"),
      table("samples and rays by kind", [["Configuration"], ["Samples", "wide"], ["Rays", "wide"]], of.map((c) => [named(c), split(c.cost.samples), split(c.cost.rays)])),
    ] : null;
    const techniques = filled(report.techniques) ? [
      h("h3", {}, "By technique"),
      read("Each technique alone, one sample of it: the product of variance and nanoseconds is what a sample spent on it is worth."),
      table("cost by technique", [["Technique"], ["ns a sample", "number"], ["Second moment", "number"], ["Variance", "number"], ["Variance × ns", "number"]],
        report.techniques.map((t) => [t.name, number(t.ns_per_sample), number(t.second_moment), number(t.variance), number(t.variance_x_cost)])),
    ] : null;
    return section("cost", "Variance × cost, taken apart", total, techniques);
  }

  // ---- 9. Predicted and measured variance ----------------------------------------------------------------------------

  function predictionSection() {
    const of = configurations.filter((c) => c.prediction && filled(c.prediction.counts));
    if (!of.length) return null;
    const { place } = plot("histogram", "histograms of predicted over measured variance", "prediction", () => {
      const traces = of.map((c) => {
        const { edges, counts } = c.prediction, all = counts.reduce((a, b) => a + b, 0) || 1;
        const y = counts.map((n) => (100 * n) / all);
        return {
          uid: uidOf(c), name: safe(isNarrow() ? short(c.name, 34) : c.name), type: "scatter", mode: "lines", x: [edges[0], ...edges], y: [0, ...y, 0], line: { shape: "hv", color: colourOf(c), width: 2, dash: styleOf(c).dash },
          text: ["", ...counts.map((n, k) => `<b>${safe(c.name)}</b><br>${k === 0 ? `up to ${number(2 ** edges[1])}` : k === counts.length - 1 ? `from ${number(2 ** edges[k])} on` : `${number(2 ** edges[k])} to ${number(2 ** edges[k + 1])}`}: ${percent(n / all)} of the pixels`), ""],
          hovertemplate: "%{text}<extra></extra>",
        };
      });
      const low = Math.min(...of.map((c) => c.prediction.edges[0])), high = Math.max(...of.map((c) => c.prediction.edges[c.prediction.edges.length - 1]));
      const by = Math.max(1, Math.ceil((high - low) / (isNarrow() ? 8 : 14)));
      const ticks = [];
      for (let k = Math.ceil(low / by) * by; k <= high; k += by) ticks.push(k);
      return { traces, layout: {
        showlegend: true, legend: { orientation: "h", x: 0, y: -0.22, yanchor: "top" },
        xaxis: { range: [low, high], tickvals: ticks, ticktext: ticks.map((k) => (k < 0 ? `1/${2 ** -k}` : String(2 ** k))), title: { text: "Predicted / measured variance", standoff: 8 } },
        yaxis: { rangemode: "tozero", title: { text: "Pixels, %", standoff: 8 } },
        shapes: [{ type: "line", x0: 0, x1: 0, yref: "paper", y0: 0, y1: 1, line: { color: css("--ink"), width: 1 } }],
      } };
    });
    return section("prediction", "Predicted and measured variance",
      read("Each pixel’s own estimate of its variance, divided by the variance over the seeds. Around 1 the estimates can be trusted; the width is mostly that of a variance from so few seeds. The outermost bins hold all that lies beyond them."),
      place,
      table("predicted over measured variance", [["Configuration"], ["Median of the pixels", "number"], ["All pixels together", "number"]], of.map((c) => [named(c), number(c.prediction.median), c.prediction.pooled ? interval(c.prediction.pooled) : kNone])),
      words(of.map((c) => [c, [c.prediction.text]])));
  }

  // ---- 10. Allocation and counts -------------------------------------------------------------------------------------

  function allocationSection() {
    const of = configurations.filter((c) => c.allocation), counted = configurations.filter((c) => c.counts);
    const techniques = [...new Set(of.flatMap((c) => Object.keys(c.allocation)))].filter((k) => k !== "clamped" && k !== "starved");
    const rank = (k) => (k === "light" ? 2 : k === "cosine" ? 1 : 0);
    techniques.sort((a, b) => rank(a) - rank(b) || a.localeCompare(b));
    const title = (k) => k[0].toUpperCase() + k.slice(1);
    const shade = (n) => `color-mix(in srgb, var(--ink) ${Math.round(100 - (80 * n) / Math.max(1, techniques.length - 1))}%, var(--paper))`;
    const allocation = of.length ? [
      read("Where the samples went, averaged over the pixels. Clamped: the share of pixels in which a technique is held at its least share; starved: in which one gets no sample at all."),
      table("mean allocation", [["Configuration"], ...techniques.map((k) => [title(k), "number"]), [""], ["Clamped", "number"], ["Starved", "number"]],
        of.map((c) => [named(c), ...techniques.map((k) => percent(c.allocation[k])),
          { is: shareBar(techniques.map((k, n) => [k, c.allocation[k] || 0, shade(n)])), class: "bare" },
          percent(c.allocation.clamped), percent(c.allocation.starved)])),
      h("div", { class: "key" }, techniques.map((k, n) => h("span", {}, h("i", { style: `background:${shade(n)}` }), k))),
    ] : null;
    const any = counted.some((c) => c.counts.nan + c.counts.infinite + c.counts.negative > 0);
    const count = (n) => (n > 0 ? h("span", { class: "flag" }, integer(n)) : integer(n));
    const counts = !counted.length ? null : [
      h("h3", {}, "Values that no image should have"),
      any ? table("counts", [["Configuration"], ["Not a number", "number"], ["Infinite", "number"], ["Negative", "number"]], counted.map((c) => [named(c), count(c.counts.nan), count(c.counts.infinite), count(c.counts.negative)]))
        : h("p", {}, `Not a number, infinite, negative: none in ${counted.map((c) => c.name).join(", ")}.`),
    ];
    return section("allocation", "Allocation and counts", allocation, counts);
  }

  // ---- 11. Ways ------------------------------------------------------------------------------------------------------

  // The pyramid of what each way to make a path brings: a row for each length, as the pictures of the group "ways" have it.
  function waysSection() {
    const of = configurations.filter((c) => c.ways);
    if (!of.length) return null;
    const small = (x) => (x >= 0.005 ? `${Math.round(100 * x)} %` : x > 0 ? "< 1 %" : "0 %");
    const surfaces = (n) => (n === 1 ? "1 surface" : `${n} surfaces`);
    return section("ways", "Ways to make a path",
      read("A path may be made by the camera up to where a light is found, by a light up to the lens, or by both, connected. Of each way: the small image of what it brings with its weight, its share of the variance and its share of the cost, in rays. The rows are paths of one surface, of two, and so on; in each column a light makes one more of them. Without the weights the images are in the viewer, as “ways alone”."),
      of.map((c) => {
        const { ways } = c, rows = Math.max(...ways.list.map((way) => way.surfaces));
        const index = (report.images || []).findIndex((image) => image.group === "ways" && image.configuration === c.name);
        const cells = [];
        const cell = (way) => {
          const light = way.surfaces - way.by_camera;
          const canvas = h("canvas", { width: ways.width, height: ways.height, role: "img", "aria-label": `${way.by_camera} by the camera, ${light} by a light` });
          cells.push({ canvas, way });
          return h("figure", {}, canvas, h("figcaption", {}, light === 0 ? "camera alone" : way.by_camera === 0 ? "to the film" : `${way.by_camera} + ${light}`, h("br"), `${small(way.variance)} · ${small(way.cost)}`));
        };
        if (index >= 0)
          started.push(async () => {
            const image = report.images[index];
            const png = await decodePng(document.getElementById(`image-${index}`).textContent);
            const all = develop(image, png, 0);
            for (const { canvas, way } of cells)
              canvas.getContext("2d").putImageData(all, -(way.surfaces - way.by_camera) * ways.width, -(way.surfaces - 1) * ways.height);
          });
        return [
          h("h3", {}, named(c)),
          h("p", {}, `Samples at a first hit ${brief(ways.samples_at_hit)}, connections of it ${brief(ways.connections)} and of each later vertex ${brief(ways.later_connections)}, in mean over the pixels; paths from the lights for each camera sample ${brief(ways.light_paths)}.`),
          h("div", { class: "ways", role: "list", "aria-label": `ways of ${c.name}: share of the variance, share of the cost` }, Array.from({ length: rows }, (_, n) =>
            h("div", { role: "listitem" }, h("span", {}, surfaces(n + 1)), ways.list.filter((way) => way.surfaces === n + 1).sort((a, b) => b.by_camera - a.by_camera).map(cell)))),
        ];
      }));
  }

  // ---- 12. Models ----------------------------------------------------------------------------------------------------

  function modelsSection() {
    if (!filled(report.models)) return null;
    const signed = (x) => (known(x) && x > 0 ? `+${number(x)}` : number(x));
    const agree = (a) => (a === true ? "agree" : a === false ? "differ" : "not tested");
    return h("section", { id: "models", class: "apart", "aria-labelledby": "models-title" },
      h("h2", { id: "models-title" }, "Models", " ", h("small", {}, "differences, not errors")),
      read("Images that have converged, compared with each other. What is left here does not go away with more samples: the renderers compute different things. It says nothing about who converges faster."),
      table("differences of the models", [["Renderer"], ["Against"], ["Relative difference²", "number"], ["Difference²", "number"], ["Mean R", "number"], ["Mean G", "number"], ["Mean B", "number"], ["Test", "word-column"]],
        report.models.map((m) => [m.name, m.against, number(m.difference.relmse), number(m.difference.mse), ...["r", "g", "b"].map((k) => (m.difference.mean ? signed(m.difference.mean[k]) : kNone)), agree(m.agree)])),
      report.models.filter((m) => m.text).map((m) => h("p", {}, m.text.startsWith(m.name) ? m.text : `${m.name}: ${m.text}`)));
  }

  // ---- 13. Method ----------------------------------------------------------------------------------------------------

  function runsOf(list) {
    const ordered = [...list].sort((a, b) => a - b), parts = [];
    for (let i = 0; i < ordered.length;) {
      let j = i;
      while (j + 1 < ordered.length && ordered[j + 1] === ordered[j] + 1) ++j;
      parts.push(j > i ? `${ordered[i]}–${ordered[j]}` : `${ordered[i]}`);
      i = j + 1;
    }
    return parts.join(", ");
  }

  function methodSection() {
    const reference = report.reference || {}, p = report.provenance || {}, floor = reference.floor || {};
    const list = (items) => (filled(items) ? items.join(", ") : kNone);
    const settings = (c) => Object.entries(c.settings || {}).map(([k, v]) => `${k}=${v !== null && typeof v === "object" ? JSON.stringify(v) : typeof v === "number" ? Number(v.toPrecision(6)) : v}`).join(" ");
    const spread = p.timing_spread ? Object.entries(p.timing_spread).map(([k, v]) => `${k} ${number(v)}`).join(", ") : null;
    const joined = (...parts) => parts.filter((t) => known(t) && t !== "").join(", ");
    return section("method", "Method",
      h("h3", {}, "Errors"),
      read("x is a value of the image, r of the reference, ε keeps dark pixels from counting without bound. Means are over pixels and colours, then over the seeds; intervals are 95 %."),
      table("metrics", [["Error"], ["Formula", "wide"], ["ε", "number"], ["Reference’s own error", "word-column"]],
        report.metrics.map((m) => [m.label, h("code", {}, m.formula || kNone), known(m.epsilon) ? String(m.epsilon) : kNone, m.floor_subtracted ? "subtracted" : "not subtracted"])),
      h("h3", {}, "Study"),
      facts("study", [
        ["Reference", joined({ made: "rendered for this study", given: "given" }[reference.source] || reference.source, known(reference.spp) ? `${integer(reference.spp)} samples per pixel` : null,
          known(reference.seconds) ? `${number(reference.seconds)} s` : null, known(reference.chunks) ? `${reference.chunks} independent parts` : null, reference.path)],
        ["Its own error", joined(known(floor.mse) ? `MSE ${number(floor.mse)}` : null, known(floor.relmse) ? `relMSE ${number(floor.relmse)}` : null) || "not known"],
        ["Seeds", filled(report.seeds) ? runsOf(report.seeds) : null],
        ["Checkpoints", filled(report.checkpoints) ? `${report.checkpoints.join(", ")} samples per pixel` : null],
        ["Baseline", baseline.name],
      ]),
      h("h3", {}, "Configurations"),
      table("configurations", [["Configuration"], ["Renderer"], ["What it is", "wide"], ["Runs", "number"], ["Kernel", "word-column"], ["Left out"]],
        configurations.map((c) => [named(c), c.renderer, c.description || settings(c) ? h("span", {}, c.description || "", " ", h("span", { class: "settings" }, settings(c))) : kNone,
          integer(c.runs), c.kernel || kNone, list(c.left_out)]), "long"),
      h("h3", {}, "Provenance"),
      facts("provenance", [
        ["WardMIS", joined(p.version || report.version, p.compiler)], ["Flags", p.flags ? h("code", {}, p.flags) : null],
        ["Processor", joined(p.cpu, p.isa, known(p.cores) ? `${p.cores} cores` : null, known(p.threads) ? `${p.threads} threads` : null)], ["System", p.system],
        ["Scene", joined(p.scene, p.scene_hash)], ["Started, ended", joined(date(p.started), date(p.ended))],
        ["Load average", filled(p.load) ? p.load.map((x) => x.toFixed(2)).join(", ") : null], ["Largest / median time of a run", spread],
        ["Fixed loop between the runs", p.calibration ? `${number(p.calibration.low)} to ${number(p.calibration.high)} ns: how steady the machine was` : null],
        ["Command", p.command ? h("code", {}, p.command) : null],
      ]));
  }

  // ---- The page ------------------------------------------------------------------------------------------------------

  root.dataset.theme = preference.matches ? "dark" : "light";
  document.title = report.title;
  const sections = [errorSection, targetSection, equalSection, viewerSection, biasSection, whereSection, costSection, predictionSection, allocationSection, waysSection, modelsSection, methodSection]
    .map((make) => make()).filter(known);
  const contents = h("nav", { "aria-label": "contents" }, sections.map((s) => h("a", { href: `#${s.id}` }, s.querySelector("h2").firstChild.textContent)));
  const footer = h("footer", {}, "The same numbers are in report.json and in the .csv files beside this page. It works without a network; figures are drawn by plotly.js (MIT licence).");
  document.getElementById("page").replaceChildren(head(), contents, ...sections, footer);
  applyTheme();
  for (const start of started) start();
  preference.addEventListener("change", () => applyTheme());
  window.addEventListener("beforeprint", () => { printing = true; applyTheme("light"); });
  window.addEventListener("afterprint", () => { printing = false; applyTheme(); });
  let narrow = isNarrow();
  window.addEventListener("resize", () => {
    if (isNarrow() !== narrow) { narrow = !narrow; applyTheme(); }
  });
})();
