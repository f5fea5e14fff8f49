"use strict";
/* Everything on the page that is no plot and no picture: facts, tables, histogram. */
const tables = (function () {
  const $ = id => document.getElementById(id);
  const SVG = "http://www.w3.org/2000/svg";
  const STEP = 2000; /* rows of events shown at once */
  let shown = STEP, hidden = new Set(), seek = null;

  const number = (v, digits) => v.toFixed(digits).replace("-", "−");
  const round = v => String(Number(v.toPrecision(6))).replace("-", "−");

  function time(ns) {
    return ns < 1e3 ? `${ns.toFixed(0)} ns` : ns < 1e6 ? `${(ns / 1e3).toPrecision(3)} µs` :
      ns < 1e9 ? `${(ns / 1e6).toPrecision(3)} ms` : `${(ns / 1e9).toPrecision(3)} s`;
  }

  function cell(row, text, tag) {
    const c = document.createElement(tag || "td");
    c.textContent = text;
    row.append(c);
    return c;
  }

  function pairs(table, list) {
    for (const [name, value] of list) {
      const row = table.insertRow();
      cell(row, name, "th");
      cell(row, value);
    }
  }

  function grid(table, head, rows) {
    const tr = table.createTHead().insertRow(), body = table.createTBody();
    head.forEach(text => cell(tr, text, "th"));
    for (const r of rows) {
      const row = body.insertRow();
      r.forEach(text => cell(row, text));
    }
  }

  function facts(m) {
    const run = m.run, list = [[number(run.seconds, 2) + " s", "duration"], [run.rows, "samples"],
      [m.slips[m.rows - 1] - 0, "slips"], [number(m.largestNormal, 2) + " N", "largest normal force"]];
    if (run.timing) {
      const frame = run.timing.stages.find(s => s.name === "frame");
      list.push([run.timing.missed, `missed ${run.timing.target_hz} Hz`]);
      if (frame)
        list.push([time(frame.p99), "99 % of samples"]);
    }
    for (const [value, name] of list) {
      const li = document.createElement("li"), b = document.createElement("b"), s = document.createElement("span");
      b.textContent = value;
      s.textContent = name;
      li.append(b, s);
      $("facts").append(li);
    }
    const base = p => p.split("/").pop();
    $("subtitle").textContent = `${base(run.scene_path)} · ${run.input_kind} ${run.input === "-" ? "from standard input" : base(run.input)}` +
      ` · accuracy ${run.solver.accuracy} · ${run.solver.precision}`;
  }

  function parameters(m) {
    const {scene, solver} = m.run;
    const list = [
      ["object", `${scene.vertices.length} vertices: ` + scene.vertices.map(v => `(${round(v[0])}, ${round(v[1])})`).join(" ") + ` m, depth ${round(scene.depth)} m`],
      ["stiffness", `k_p = ${round(scene.stiffness)} N/m, k_θ = ${round(scene.rotational_stiffness)} N m/rad`],
      ["hold", scene.hold === "start" ? `from the start, at (${scene.holding_point.map(round).join(", ")}) m of the body` :
        `by the button, within ${round(scene.reach)} m`],
      ["accuracy", solver.accuracy + (solver.accuracy === "event" ? `, h_min ${solver.h_min} of the object's size` : "")],
      ["precision", solver.precision],
    ];
    if (solver.set.length)
      list.push(["overridden", solver.set.join("  ")]);
    pairs($("parameters"), list);
    grid($("surfaces"), ["surface", "point / m", "normal / °", "μ_s", "μ_d"], scene.surfaces.map((s, i) =>
      [s.name || `surface ${i}`, `(${s.point.map(round).join(", ")})`, round(s.normal_deg), round(s.mu_static), round(s.mu_dynamic)]));
  }

  function provenance(m) {
    const run = m.run;
    pairs($("provenance"), [
      ["program", `stiction ${run.version}`],
      ["command", run.command],
      ["scene", run.scene_path],
      [run.input_kind, run.input === "-" ? "standard input" : run.input],
      ["SHA-256", run.sha256 || "not known (not a file)"],
      ["pictures", run.video.mime ? `${m.frames} frames, ${run.fps} a second, ${(run.video.size / 1e6).toFixed(2)} MB` : run.video.why || "none"],
    ].concat(run.timing ? [["machine", run.timing.machine]] : []).filter(p => p[1]));
    for (const row of $("provenance").rows)
      if (row.cells[0].textContent === "SHA-256")
        row.cells[1].className = "hash";
    $("scene-text").textContent = run.scene_text;
  }

  function node(parent, name, attributes, text) {
    const n = document.createElementNS(SVG, name);
    for (const key in attributes)
      n.setAttribute(key, attributes[key]);
    if (text !== undefined)
      n.textContent = text;
    parent.append(n);
    return n;
  }

  /* Counts per twelfth of a decade, from the fastest sample to beyond the deadline. */
  function histogram(m) {
    const box = $("histogram");
    if (!m.frame_us) {
      box.innerHTML = '<p class="muted">Not measured in this run; replay with <code>--timing FILE</code> to see what each sample cost.</p>';
      return;
    }
    const per = 12, deadline = 1e6 / m.run.timing.target_hz, w = 600, h = 190, left = 40, right = 12, top = 26, bottom = 34;
    const low = Math.floor(Math.log10(Math.max(Math.min(...m.frame_us.slice(0, 1e5)), 0.01)));
    const high = Math.ceil(Math.log10(deadline)) + 0.2, counts = {};
    for (const us of m.frame_us) {
      const bin = Math.floor(Math.log10(Math.max(us, 0.01)) * per);
      counts[bin] = (counts[bin] || 0) + 1;
    }
    const most = Math.max(...Object.values(counts));
    const x = v => left + (v - low) / (high - low) * (w - left - right);
    const y = n => h - bottom - (n > 0 ? (0.06 + 0.94 * n / most) * (h - top - bottom) : 0);
    const svg = node(box, "svg", {viewBox: `0 0 ${w} ${h}`, role: "img", "aria-label": "Histogram of computing times per sample"});
    const bars = node(svg, "g", {class: "bars"}), late = node(svg, "g", {class: "late"});
    for (const bin in counts) {
      const from = x(bin / per), to = x((Number(bin) + 1) / per);
      node(10 ** (bin / per) > deadline ? late : bars, "rect",
           {x: from + 0.5, y: y(counts[bin]), width: to - from - 1, height: h - bottom - y(counts[bin])})
        .append(Object.assign(document.createElementNS(SVG, "title"), {textContent: `${counts[bin]} samples`}));
    }
    node(svg, "line", {class: "axis", x1: left, x2: w - right, y1: h - bottom, y2: h - bottom});
    for (let d = low; d <= high; d++) {
      node(svg, "line", {class: "axis", x1: x(d), x2: x(d), y1: h - bottom, y2: h - bottom + 4});
      node(svg, "text", {x: x(d), y: h - bottom + 16, "text-anchor": "middle"}, time(10 ** (d + 3)).replace(/\.0+ /, " "));
    }
    node(svg, "text", {x: left - 6, y: y(most) + 4, "text-anchor": "end"}, most);
    node(svg, "text", {x: left - 6, y: h - bottom, "text-anchor": "end"}, 0);
    node(svg, "text", {x: left, y: 12}, "samples");
    node(svg, "text", {x: (left + w - right) / 2, y: h - 3, "text-anchor": "middle"}, "computing time of a sample");
    const at = x(Math.log10(deadline));
    node(svg, "line", {class: "deadline", x1: at, x2: at, y1: top - 8, y2: h - bottom});
    node(svg, "text", {class: "deadline-text", x: at - 6, y: 14, "text-anchor": "end"},
         `deadline of ${m.run.timing.target_hz} Hz: ${time(deadline * 1e3)}`);
    grid($("stages"), ["stage", "count", "median", "99 %", "99.9 %", "longest"], m.run.timing.stages.map(s =>
      [s.name === "frame" ? "all of a sample" : s.name, s.count, time(s.p50), time(s.p99), time(s.p999), time(s.max)]));
  }

  /* ---- events ------------------------------------------------------------------------------- */

  function eventText(m, i) {
    const kind = m.run.kinds[m.e_kind[i]], surface = m.e_surface[i];
    return [number(m.run.start + m.e_t[i], 6), kind, m.e_vertex[i] < 0 ? "" : m.e_vertex[i],
      surface < 0 ? "" : m.run.scene.surfaces[surface].name || surface, number(m.e_x[i], 5), number(m.e_y[i], 5),
      kind === "slip" ? number(m.e_length[i] * 1e3, 3) + " mm" : kind === "snap" ? number(m.e_length[i] * 180 / Math.PI, 2) + "°" : ""];
  }

  function fillEvents(m) {
    const body = $("events").tBodies[0], list = m.eventOrder.filter(i => !hidden.has(m.e_kind[i]));
    body.textContent = "";
    for (const i of list.slice(0, shown)) {
      const row = body.insertRow();
      row.dataset.event = i;
      eventText(m, i).forEach(text => cell(row, text));
    }
    $("more-events").hidden = list.length <= shown;
    $("event-count").textContent = list.length === m.run.events ? `${list.length}` : `${list.length} of ${m.run.events}`;
  }

  function events(m) {
    const counts = {};
    for (const kind of m.e_kind)
      counts[kind] = (counts[kind] || 0) + 1;
    for (const kind in counts) {
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.checked = true;
      box.onchange = () => {
        box.checked ? hidden.delete(Number(kind)) : hidden.add(Number(kind));
        fillEvents(m);
        tables.show(m, charts.frame);
      };
      label.append(box, `${m.run.kinds[kind]} ${counts[kind]}`);
      $("event-kinds").append(label);
    }
    $("more-events").onclick = () => { shown += STEP; fillEvents(m); };
    $("events").tBodies[0].onclick = e => {
      const row = e.target.closest("tr");
      if (row)
        seek(m.e_t[Number(row.dataset.event)]);
    };
    fillEvents(m);
  }

  /* ---- what belongs to the frame shown ------------------------------------------------------- */

  function values(m, f) {
    const r = f.row, mm = v => number(v * 1e3, 2), list = [
      ["state", m.run.states[m.state[r]] + (m.flags[r] & 1 ? ", slipped" : "") + (m.flags[r] & 2 ? ", wedged" : "") +
        (m.flags[r] & 4 ? ", no answer" : "") + (m.flags[r] & 8 ? ", limit reached" : "") + (m.flags[r] & 16 ? ", tracking lost" : "")],
      ["slips", m.slips[r]],
      ["hand", `${mm(m.hand_x[r])}, ${mm(m.hand_y[r])} mm, ${number(m.handAngle[r], 2)}°`],
      ["object", `${mm(m.x[r])}, ${mm(m.y[r])} mm, ${number(m.angle[r], 2)}°`],
      ["spring", `${number(Math.hypot(m.force_x[r], m.force_y[r]), 3)} N, ${number(m.moment[r], 4)} N m`],
    ];
    $("values").innerHTML = list.map(([name]) => `<dt>${name}</dt><dd></dd>`).join("");
    $("values").querySelectorAll("dd").forEach((dd, i) => { dd.textContent = list[i][1]; });
  }

  function contacts(m, f) {
    const body = $("contacts").tBodies[0];
    body.textContent = "";
    for (const k of m.contactsOf(f.row)) {
      const row = body.insertRow(), s = m.run.scene.surfaces[k.surface], shownSurface = m.surfaces.find(q => q.index === k.surface);
      const first = cell(row, ""), dot = document.createElement("i");
      dot.className = "swatch";
      dot.style.background = shownSurface ? `var(${shownSurface.color})` : "var(--muted)";
      first.append(dot, `${k.vertex} on ${s.name || k.surface}`);
      first.title = `vertex ${k.vertex} on surface ${k.surface}`;
      cell(row, `${number(k.normal, 2)} N`);
      cell(row, `${number(k.friction, 2)} N`);
      const limit = s.mu_static * k.normal, used = limit > 0 ? Math.abs(k.friction) / limit : 0;
      const last = cell(row, ""), bar = document.createElement("span"), fill = document.createElement("i");
      bar.className = "bar";
      fill.style.width = `${Math.min(100, 100 * used)}%`;
      bar.append(fill);
      last.append(bar, limit > 0 ? `${Math.round(100 * used)} %` : "–");
    }
    if (!body.rows.length)
      cell(body.insertRow(), "none").colSpan = 4;
  }

  function markEvents(m, f) {
    let current = null;
    for (const row of $("events").tBodies[0].rows) {
      const t = m.e_t[Number(row.dataset.event)];
      const past = t <= f.t + 1e-9, now = past && t > f.t - 1 / m.run.fps;
      row.className = now ? "current" : past ? "past" : "";
      if (past)
        current = row;
    }
    const box = document.querySelector(".scroll");
    if (current && !box.matches(":hover"))
      box.scrollTop = current.offsetTop - box.clientHeight / 2;
  }

  return {
    build(m, onSeek) {
      seek = onSeek;
      facts(m);
      parameters(m);
      provenance(m);
      histogram(m);
      events(m);
    },
    show(m, f) {
      values(m, f);
      contacts(m, f);
      markEvents(m, f);
    },
  };
})();
