"use strict";
/* Reads the run out of the page, and plays it: the frame shown is the one truth, all else follows. */
const stiction = (function () {
  const $ = id => document.getElementById(id);

  function bytesOf(id) {
    const text = $(id).textContent;
    if (Uint8Array.fromBase64)
      return Uint8Array.fromBase64(text);
    const binary = atob(text), bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; i++)
      bytes[i] = binary.charCodeAt(i);
    return bytes;
  }

  /* ---- data ---------------------------------------------------------------------------------- */

  const KINDS = {f64: Float64Array, f32: Float32Array, u32: Uint32Array, i16: Int16Array, u8: Uint8Array};

  function columns(run) {
    const buffer = bytesOf("data").buffer, m = {run, rows: run.rows};
    let at = 0;
    for (const [name, kind, size] of run.columns) {
      m[name] = new KINDS[kind](buffer, at, size / KINDS[kind].BYTES_PER_ELEMENT);
      at += Math.ceil(size / 8) * 8;
    }
    return m;
  }

  /* Forces and friction limits summed per surface: of an edge's friction only the sum is determined. */
  function forces(m) {
    const order = [], found = new Map(), n = m.rows;
    let k = 0;
    m.largestNormal = m.largestForce = 0;
    m.firstContact = new Uint32Array(n + 1);
    for (let row = 0; row < n; row++) {
      for (const end = k + m.contacts[row]; k < end; k++) {
        const index = m.c_surface[k];
        let s = found.get(index);
        if (!s) {
          s = {index, name: m.run.scene.surfaces[index].name || `surface ${index}`,
               normal: Array(n).fill(null), friction: Array(n).fill(null)};
          found.set(index, s);
          order.push(s);
        }
        s.normal[row] += m.c_normal[k];
        s.friction[row] += m.c_friction[k];
        m.largestNormal = Math.max(m.largestNormal, m.c_normal[k]);
        m.largestForce = Math.max(m.largestForce, Math.hypot(m.c_normal[k], m.c_friction[k]));
      }
      m.firstContact[row + 1] = k;
    }
    /* Curves of as many as have colours: those that were touched in most rows. */
    const rowsOf = s => s.normal.reduce((count, v) => count + (v !== null), 0), longest = new Map(order.map(s => [s, rowsOf(s)]));
    m.touched = order.length;
    m.surfaces = order.sort((a, b) => longest.get(b) - longest.get(a) || a.index - b.index).slice(0, 4)
                      .sort((a, b) => a.index - b.index);
    m.surfaces.forEach((s, i) => {
      const mu = m.run.scene.surfaces[s.index].mu_static;
      s.color = `--surface-${i}`;
      s.limit = s.normal.map(v => v === null ? null : mu * v);
      s.used = s.normal.map((v, row) => v > 0 && mu > 0 ? Math.abs(s.friction[row]) / (mu * v) : null);
    });
  }

  function model(run) {
    const m = columns(run), degrees = a => Array.from(a, v => v * 180 / Math.PI);
    m.angle = degrees(m.theta);
    m.handAngle = degrees(m.hand_theta);
    m.frame_us = run.timing && m.frame_us.length === m.rows && m.rows > 0 ? Array.from(m.frame_us) : null;
    /* Hand and object are compared where the spring joins them: what is between the curves is its stretch. */
    const held = Array.from(m.state, v => run.states[v] !== "released");
    const centred = run.scene.hold === "start" && run.scene.holding_point.every(v => v === 0);
    m.objectName = centred ? "object" : "object, where held";
    m.objectX = held.map((h, row) => h ? m.hold_x[row] : null);
    m.objectY = held.map((h, row) => h ? m.hold_y[row] : null);
    m.slipRows = [];
    m.stateRows = [];
    for (let row = 0; row < m.rows; row++) {
      if (m.flags[row] & 1)
        m.slipRows.push(row);
      if (row > 0 && m.state[row] !== m.state[row - 1])
        m.stateRows.push(row);
    }
    m.eventOrder = Array.from(m.e_t, (_, i) => i).sort((a, b) => m.e_t[a] - m.e_t[b] || a - b);
    m.contactsOf = row => {
      const list = [];
      for (let k = m.firstContact[row]; k < m.firstContact[row + 1]; k++)
        list.push({vertex: m.c_vertex[k], surface: m.c_surface[k], x: m.c_x[k], y: m.c_y[k], normal: m.c_normal[k], friction: m.c_friction[k]});
      return list;
    };
    forces(m);
    m.frames = m.rows ? Math.floor(run.seconds * run.fps + 1e-6) + 1 : 0;
    m.frameRow = new Uint32Array(m.frames);
    for (let i = 0, row = 0; i < m.frames; i++) {
      while (row + 1 < m.rows && m.t[row + 1] <= i / run.fps + 1e-9)
        row++;
      m.frameRow[i] = row;
    }
    return m;
  }

  /* The first frame that shows what happened up to time t. */
  const frameAt = t => Math.max(0, Math.min(m.frames - 1, Math.ceil(t * fps - 1e-6)));
  const frameOfRow = row => frameAt(m.t[row]);

  const run = JSON.parse($("run").textContent), m = model(run), fps = run.fps;
  const video = $("video");
  let frame = 0, playing = false, videoReady = false, wanted = null, started = null, drawSketch = null;

  /* ---- the frame shown ----------------------------------------------------------------------- */

  function present(i) {
    frame = i;
    const f = {t: i / fps, row: m.frameRow[i]};
    $("scrubber").value = i;
    $("clock").innerHTML = `<b>${(run.start + f.t).toFixed(3)} s</b> &nbsp;frame ${i} <span class="muted">of ${m.frames - 1}</span>`;
    charts.show(f);
    tables.show(m, f);
    if (drawSketch)
      drawSketch(f.row);
  }

  /* The middle of the frame: its edges belong to one frame or the other, as the player rounds. */
  function seekVideo() {
    if (!videoReady || video.seeking)
      return;
    const t = (frame + 0.5) / fps;
    wanted = frame;
    if (Math.abs(video.currentTime - t) > 1e-6)
      video.currentTime = t;
  }

  function go(i) {
    if (!m.frames)
      return;
    if (playing)
      pause();
    present(Math.max(0, Math.min(m.frames - 1, i)));
    seekVideo();
  }

  /* ---- playing ------------------------------------------------------------------------------- */

  const speed = () => Number($("speed").value);

  function tick(now) {
    if (!playing || videoReady)
      return;
    const i = started.frame + Math.floor((now - started.now) / 1000 * fps * speed());
    if (i >= m.frames - 1) {
      present(m.frames - 1);
      pause();
      return;
    }
    if (i !== frame)
      present(i);
    requestAnimationFrame(tick);
  }

  function follow(now, info) {
    if (!playing)
      return;
    const t = info ? Math.round(info.mediaTime * fps) : Math.floor(video.currentTime * fps);
    present(Math.max(0, Math.min(m.frames - 1, t)));
    next();
  }

  function next() {
    if (video.requestVideoFrameCallback)
      video.requestVideoFrameCallback(follow);
    else
      requestAnimationFrame(() => follow(0, null));
  }

  function play() {
    if (!m.frames || playing)
      return;
    if (frame === m.frames - 1)
      go(0);
    playing = true;
    $("play").textContent = "❚❚";
    if (videoReady) {
      video.playbackRate = speed();
      next();
      video.play().catch(pause);
    } else {
      started = {frame, now: performance.now()};
      requestAnimationFrame(tick);
    }
  }

  function pause() {
    playing = false;
    $("play").textContent = "▶";
    if (videoReady) {
      video.pause();
      seekVideo();
    }
  }

  /* ---- stepping ------------------------------------------------------------------------------ */

  function jump(rows, forward) {
    let target = null;
    for (const row of rows) {
      const i = frameOfRow(row);
      if (forward && i > frame)
        return go(i);
      if (!forward && i < frame)
        target = i;
    }
    if (target !== null)
      go(target);
  }

  const actions = {
    "play": () => playing ? pause() : play(),
    "prev": () => go(frame - 1),
    "next": () => go(frame + 1),
    "prev-slip": () => jump(m.slipRows, false),
    "next-slip": () => jump(m.slipRows, true),
    "prev-state": () => jump(m.stateRows, false),
    "next-state": () => jump(m.stateRows, true),
    "help": () => $("help").open ? $("help").close() : $("help").showModal(),
  };
  const keys = {
    " ": actions.play, "ArrowLeft": e => go(frame - (e.shiftKey ? 10 : 1)), "ArrowRight": e => go(frame + (e.shiftKey ? 10 : 1)),
    "Home": () => go(0), "End": () => go(m.frames - 1), "n": actions["next-slip"], "p": actions["prev-slip"],
    "s": actions["next-state"], "S": actions["prev-state"], "?": actions.help,
    "+": () => changeSpeed(1), "-": () => changeSpeed(-1),
  };

  function changeSpeed(by) {
    const list = $("speed");
    list.selectedIndex = Math.max(0, Math.min(list.options.length - 1, list.selectedIndex + by));
    list.onchange();
  }

  function connect() {
    document.addEventListener("keydown", e => {
      if (e.ctrlKey || e.metaKey || e.altKey || !keys[e.key] || (e.target.tagName === "SELECT" && e.key !== " "))
        return;
      if ($("help").open && e.key !== "?")
        return;
      e.preventDefault();
      keys[e.key](e);
    });
    document.querySelectorAll("[data-do]").forEach(b => {
      b.addEventListener("click", () => actions[b.dataset.do]());
      b.addEventListener("keyup", e => { if (e.key === " ") e.preventDefault(); });
    });
    $("help-button").onclick = actions.help;
    $("scrubber").max = Math.max(0, m.frames - 1);
    $("scrubber").oninput = () => go(Number($("scrubber").value));
    $("speed").onchange = () => {
      video.playbackRate = speed();
      started = {frame, now: performance.now()};
    };
    video.addEventListener("seeked", () => { if (wanted !== frame && !playing) seekVideo(); });
    video.addEventListener("ended", () => { if (playing) { present(m.frames - 1); pause(); } });
    video.addEventListener("click", actions.play);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
    addEventListener("resize", () => { charts.resize($("plots"), false); band(); present(frame); });
    addEventListener("beforeprint", () => { document.documentElement.classList.add("printing"); charts.resize($("plots"), true); repaint(); });
    addEventListener("afterprint", () => { document.documentElement.classList.remove("printing"); charts.resize($("plots"), false); repaint(); });
  }

  /* ---- the band of states under the picture -------------------------------------------------- */

  function band() {
    const canvas = $("band"), c = canvas.getContext("2d"), ratio = devicePixelRatio, w = canvas.clientWidth, h = canvas.clientHeight;
    const last = Math.max(m.frames - 1, 1) / fps, x = t => 1.5 + Math.min(t / last, 1) * (w - 3);
    canvas.width = w * ratio;
    canvas.height = h * ratio;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    c.textBaseline = "middle";
    const starts = m.rows ? [0].concat(m.stateRows) : [];
    starts.forEach((row, i) => {
      const from = x(m.t[row]), to = i + 1 < starts.length ? x(m.t[starts[i + 1]]) : w, name = run.states[m.state[row]];
      c.fillStyle = charts.css(`--state-${m.state[row]}`);
      c.fillRect(from, 0, to - from + 0.5, h - 12);
      if (to - from > c.measureText(name).width + 10) {
        c.fillStyle = charts.css("--text");
        c.fillText(name, from + 5, (h - 12) / 2);
      }
    });
    c.fillStyle = charts.css("--grid");
    c.fillRect(0, h - 12, w, 12);
    c.fillStyle = charts.css("--slip");
    for (const row of m.slipRows)
      c.fillRect(x(m.t[row]) - 0.75, h - 11, 1.5, 10);
  }

  function bandKey() {
    const used = new Set(m.state);
    let html = "";
    run.states.forEach((name, i) => {
      if (used.has(i))
        html += `<li><i style="background:var(--state-${i});border:1px solid var(--line)"></i>${name}</li>`;
    });
    $("band-key").innerHTML = html + (m.slipRows.length ? `<li><i style="background:var(--slip);width:3px"></i>slip</li>` : "");
  }

  function repaint() {
    charts.repaint();
    band();
    present(frame);
  }

  /* ---- video --------------------------------------------------------------------------------- */

  function useSketch(note) {
    video.hidden = true;
    $("sketch").hidden = false;
    $("screen-note").hidden = false;
    $("screen-note").textContent = `Drawn from the data${note ? ": " + note : ""}`;
    drawSketch = m.rows ? sketch($("sketch"), m) : null;
    present(frame);
    document.documentElement.dataset.video = "none";
  }

  function loadVideo() {
    if (!m.rows)
      return;
    if (!run.video.mime)
      return useSketch(run.video.why);
    const url = URL.createObjectURL(new Blob([bytesOf("video-data")], {type: run.video.mime}));
    $("video-data").remove();
    video.addEventListener("error", () => {
      videoReady = false;
      useSketch("this browser cannot show the video");
    });
    video.addEventListener("loadeddata", () => {
      videoReady = true;
      document.documentElement.dataset.video = "ready";
      seekVideo();
    }, {once: true});
    video.src = url;
  }

  function begin() {
    tables.build(m, t => go(frameAt(t)));
    bandKey();
    charts.build(m, $("plots"), t => go(Math.round(t * fps)));
    connect();
    band();
    const at = /^#t=([0-9.]+)$/.exec(location.hash);
    if (m.frames)
      present(at ? frameAt(Number(at[1]) - run.start) : 0);
    document.documentElement.dataset.ready = "yes";
  }

  begin();
  return {loadVideo, go, model: m, get frame() { return frame; }, get playing() { return playing; }, video};
})();
