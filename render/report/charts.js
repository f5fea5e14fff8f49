"use strict";
/* The plots over time. Each is a uPlot; a line of our own marks the frame that is shown, as moving it
 * costs nothing while drawing the plots again would. */
const charts = (function () {
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const syncKey = "time";
  let panels = [], model = null, onSeek = null, zooming = false;

  /* What the panels show: series by name, colour and look. `limits` are drawn thin and have no value. */
  function describe(m) {
    const list = [
      {title: "x", unit: "m", digits: 4, series: [
        {name: "hand", color: "--hand", dash: [5, 3], y: m.hand_x}, {name: m.objectName, color: "--object", y: m.objectX}]},
      {title: "y", unit: "m", digits: 4, series: [
        {name: "hand", color: "--hand", dash: [5, 3], y: m.hand_y}, {name: m.objectName, color: "--object", y: m.objectY}]},
      {title: "angle", unit: "°", digits: 2, series: [
        {name: "hand", color: "--hand", dash: [5, 3], y: m.handAngle}, {name: "object", color: "--object", y: m.angle}]},
      {title: "normal force", unit: "N", digits: 2, floor: 0, more: m.touched - m.surfaces.length,
       series: m.surfaces.map(s => ({name: s.name, color: s.color, y: s.normal}))},
      {title: "friction", unit: "N", digits: 2, series: [].concat(...m.surfaces.map(s => [
        {name: s.name, color: s.color, y: s.friction}])).concat(m.surfaces.length > 2 ? [] : [].concat(...m.surfaces.map((s, i) => [
        {name: "± limit", color: s.color, y: s.limit, thin: true, quiet: i > 0}, {name: "", color: s.color, y: s.limit.map(v => v === null ? null : -v), thin: true, quiet: true}])))},
      {title: "friction ÷ static limit", unit: "", digits: 2, range: [0, 1.38], line: 1,
       series: m.surfaces.map(s => ({name: s.name, color: s.color, y: s.used}))},
    ];
    if (m.surfaces.length === 0)
      list.splice(3, 3);
    if (m.frame_us)
      list.push({title: "computing time", unit: "µs", digits: 1, log: true,
                 series: [{name: "per sample", color: "--spring", y: m.frame_us}]});
    return list;
  }

  function drawMarks(u) {
    const {ctx, bbox} = u, ratio = devicePixelRatio;
    const [low, high] = [u.scales.x.min, u.scales.x.max];

    ctx.save();
    ctx.strokeStyle = css("--slip");
    ctx.globalAlpha = model.slipRows.length > 400 ? 0.12 : 0.28;
    ctx.lineWidth = ratio;
    ctx.setLineDash([]);
    ctx.beginPath();
    for (const row of model.slipRows) {
      if (model.t[row] < low || model.t[row] > high)
        continue;
      const x = Math.round(u.valToPos(model.t[row], "x", true)) + 0.5;
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
    }
    ctx.stroke();
    ctx.restore();
  }

  function drawLine(u, value) {
    const y = Math.round(u.valToPos(value, "y", true)) + 0.5, {ctx, bbox} = u;

    ctx.save();
    ctx.strokeStyle = css("--muted");
    ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.restore();
  }

  function shareZoom(u, key) {
    if (key !== "x" || zooming)
      return;
    zooming = true;
    for (const p of panels)
      if (p.plot && p.plot !== u)
        p.plot.setScale("x", {min: u.scales.x.min, max: u.scales.x.max});
    zooming = false;
    requestAnimationFrame(() => charts.show(charts.frame));
  }

  function seekOnClick(u) {
    let downAt = null;

    u.over.addEventListener("mousedown", e => { downAt = e.clientX; });
    u.over.addEventListener("click", e => {
      if (downAt !== null && Math.abs(e.clientX - downAt) < 4)
        onSeek(u.posToVal(e.clientX - u.over.getBoundingClientRect().left, "x"));
    });
  }

  function yRange(d) {
    return (u, low, high) => {
      if (d.range)
        return d.range;
      if (low === null)
        return [0, 1];
      if (d.log)
        return [10 ** Math.floor(Math.log10(Math.max(low, 1e-3))), Math.max(10 ** Math.ceil(Math.log10(high)), 1)];
      /* Room for the label above; a flat line in the middle of numbers that can be told apart. */
      const size = Math.abs(high), span = high > low ? Math.max(high - low, size * 1e-3) : Math.max(size / 10, 20 * 10 ** -d.digits);
      return [d.floor === 0 && low >= 0 ? 0 : low - 0.08 * span, high + 0.26 * span];
    };
  }

  /* With the decimals that the step needs; uPlot's own numbers stop at three. */
  function numbers(u, splits, axis, space, step) {
    let decimals = 0;

    while (decimals < 12 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6)
      decimals++;
    return splits.map(v => v === null ? null : decimals > 5 ? v.toExponential(1)
                                                            : (Math.round(v * 10 ** decimals) / 10 ** decimals + 0).toFixed(decimals));
  }

  function options(d, width, height, last) {
    const font = "11px system-ui, 'DejaVu Sans', sans-serif";
    const grid = {stroke: () => css("--grid"), width: 1}, ticks = {show: false};
    const stroke = () => css("--muted");
    const decades = (u, v) => v.map(x => x !== null && Math.abs(Math.log10(x) % 1) < 1e-9 ? x : null);

    return {
      width, height, pxAlign: 1, legend: {show: false}, padding: [6, 10, last ? 0 : 6, 0],
      scales: {x: {time: false}, y: {range: yRange(d), distr: d.log ? 3 : 1}},
      cursor: {y: false, points: {show: false}, drag: {x: true, y: false, dist: 5}, sync: {key: syncKey, setSeries: false}},
      axes: [
        {stroke, grid, ticks, font, size: last ? 18 : 0, values: last ? numbers : (u, v) => v.map(() => ""),
         label: last ? "time / s" : undefined, labelSize: last ? 16 : 0, labelFont: font, gap: 2, labelGap: 0},
        {stroke, grid: d.log ? {...grid, filter: decades} : grid, ticks, font, size: 52, gap: 4, space: 24, values: d.log ? undefined : numbers,
         splits: d.range ? () => [0, 0.5, 1] : undefined, filter: d.log ? decades : undefined},
      ],
      series: [{}].concat(d.series.map(s => ({
        stroke: () => css(s.color), width: s.thin ? 1 : 1.6, dash: s.thin ? [2, 3] : s.dash, points: {show: model.t.length === 1}, spanGaps: false,
      }))),
      hooks: {
        drawClear: [drawMarks],
        draw: d.line ? [u => drawLine(u, d.line)] : [],
        setScale: [shareZoom],
        ready: [seekOnClick],
      },
    };
  }

  function labelFor(d) {
    const label = document.createElement("div"), values = [];

    label.className = "label";
    label.innerHTML = `<span><b>${d.title}</b>${d.unit ? " / " + d.unit : ""}</span>`;
    for (const s of d.series) {
      if (s.quiet)
        continue;
      const item = document.createElement("span"), dash = document.createElement("i"), value = document.createElement("span");
      dash.className = "dash" + (s.thin ? " dots" : s.dash ? " thin" : "");
      dash.style.color = `var(${s.color})`;
      value.className = "value";
      item.append(dash, s.name + " ", value);
      label.append(item);
      if (!s.thin)
        values.push({y: s.y, value, digits: d.digits});
    }
    if (d.more > 0)
      label.append(`and ${d.more} more`);
    return {label, values};
  }

  function make(d, box, width, height, last) {
    const panel = document.createElement("div"), now = document.createElement("div"), {label, values} = labelFor(d);

    panel.className = "panel";
    now.className = "now";
    box.append(panel);
    const plot = new uPlot(options(d, width, height, last), [model.t].concat(d.series.map(s => s.y)), panel);
    plot.over.append(now);
    panel.append(label);
    return {plot, now, values};
  }

  /* Width and heights that fill the window, without making plots too flat to read. */
  function layout(count, box, forPrint) {
    const style = getComputedStyle(box);
    const width = forPrint ? 690 : box.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
    const room = forPrint ? 780 : Math.max(innerHeight - box.getBoundingClientRect().top - scrollY - 28, 560);
    const each = Math.max(Math.floor((room - 34) / count), 84);

    return {width: Math.max(Math.floor(width), 240), each};
  }

  return {
    frame: {t: 0, row: 0},
    build(m, box, seek) {
      const list = describe(m);
      model = m;
      const {width, each} = layout(list.length, box, false);
      onSeek = seek;
      panels = list.map((d, i) => make(d, box, width, each + (i === list.length - 1 ? 34 : 0), i === list.length - 1));
    },
    resize(box, forPrint) {
      const {width, each} = layout(panels.length, box, forPrint);
      panels.forEach((p, i) => p.plot.setSize({width, height: each + (i === panels.length - 1 ? 34 : 0)}));
      this.show(this.frame);
    },
    repaint() {
      for (const p of panels)
        p.plot.redraw(false, true);
    },
    show(frame) {
      this.frame = frame;
      for (const p of panels) {
        const x = p.plot.valToPos(frame.t, "x"), inside = x >= -1 && x <= p.plot.over.clientWidth + 1;
        p.now.style.transform = `translateX(${x.toFixed(1)}px)`;
        p.now.style.visibility = inside ? "visible" : "hidden";
        for (const v of p.values) {
          const y = v.y[frame.row];
          v.value.textContent = y === null || y === undefined ? "–" : y.toFixed(v.digits).replace("-", "−");
        }
      }
    },
    panels: () => panels,
    css,
  };
})();
