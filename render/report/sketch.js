"use strict";
/* The scene drawn from the data, where there is no video: surfaces, object, hand, spring and forces. */
const sketch = (function () {
  const rotate = (p, a) => [p[0] * Math.cos(a) - p[1] * Math.sin(a), p[0] * Math.sin(a) + p[1] * Math.cos(a)];

  /* Square around all places of hand and object, with room for forces. */
  function bounds(m) {
    const reach = Math.max(...m.run.scene.vertices.map(v => Math.hypot(v[0], v[1])));
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    const add = (x, y, r) => {
      box[0] = Math.min(box[0], x - r); box[1] = Math.min(box[1], y - r);
      box[2] = Math.max(box[2], x + r); box[3] = Math.max(box[3], y + r);
    };
    for (let i = 0; i < m.rows; i++) {
      add(m.x[i], m.y[i], 1.1 * reach);
      add(m.hand_x[i], m.hand_y[i], 0.3 * reach);
    }
    return box;
  }

  /* The part of the view behind a surface, by clipping the view's rectangle. */
  function behind(s, corners) {
    const side = p => (p[0] - s.point[0]) * s.normal[0] + (p[1] - s.point[1]) * s.normal[1];
    const out = [];
    corners.forEach((p, i) => {
      const q = corners[(i + 1) % corners.length], a = side(p), b = side(q);
      if (a <= 0)
        out.push(p);
      if (a < 0 !== b < 0)
        out.push([p[0] + (q[0] - p[0]) * a / (a - b), p[1] + (q[1] - p[1]) * a / (a - b)]);
    });
    return out;
  }

  return function (canvas, m) {
    const box = bounds(m), force = m.largestForce || 1, c = canvas.getContext("2d");

    function view() {
      const ratio = devicePixelRatio, w = canvas.clientWidth, h = canvas.clientHeight;
      canvas.width = w * ratio;
      canvas.height = h * ratio;
      const scale = Math.min(w / (box[2] - box[0]), h / (box[3] - box[1])) * 0.94;
      const cx = (box[0] + box[2]) / 2, cy = (box[1] + box[3]) / 2;
      c.setTransform(ratio, 0, 0, ratio, 0, 0);
      return {w, h, scale, to: p => [w / 2 + (p[0] - cx) * scale, h / 2 - (p[1] - cy) * scale],
              corners: [[0, 0], [w, 0], [w, h], [0, h]].map(p => [(p[0] - w / 2) / scale + cx, (h / 2 - p[1]) / scale + cy])};
    }
    function path(points, close) {
      c.beginPath();
      points.forEach((p, i) => i ? c.lineTo(p[0], p[1]) : c.moveTo(p[0], p[1]));
      if (close)
        c.closePath();
    }
    function bar(from, dx, dy, color) {
      path([from, [from[0] + dx, from[1] - dy]]);
      c.lineWidth = 6;
      c.strokeStyle = color;
      c.stroke();
    }
    function outline(v, x, y, angle) {
      return m.run.scene.vertices.map(p => { const q = rotate(p, angle); return v.to([x + q[0], y + q[1]]); });
    }
    function trail(v, xs, ys, row, color) {
      path(Array.from({length: row + 1}, (_, i) => v.to([xs[i], ys[i]])));
      c.lineWidth = 1.5;
      c.strokeStyle = color;
      c.stroke();
    }

    return function (row) {
      const v = view(), css = charts.css, length = v.h * 0.3 / force;

      c.fillStyle = css("--paper");
      c.fillRect(0, 0, v.w, v.h);
      c.fillStyle = css("--solid");
      for (const s of m.run.scene.surfaces) {
        path(behind(s, v.corners).map(v.to), true);
        c.fill();
      }
      trail(v, m.hand_x, m.hand_y, row, css("--hand"));
      trail(v, m.x, m.y, row, css("--muted"));
      path(outline(v, m.x[row], m.y[row], m.theta[row]), true);
      c.globalAlpha = 0.75;
      c.fillStyle = css("--fill");
      c.fill();
      c.globalAlpha = 1;
      c.lineWidth = 2;
      c.strokeStyle = css("--object");
      c.stroke();
      if (m.run.states[m.state[row]] !== "released") {
        path([v.to([m.hold_x[row], m.hold_y[row]]), v.to([m.hand_x[row], m.hand_y[row]])]);
        c.lineWidth = 3;
        c.strokeStyle = css("--spring");
        c.stroke();
      }
      for (const k of m.contactsOf(row)) {
        const s = m.run.scene.surfaces[k.surface], at = v.to([k.x, k.y]);
        bar(at, s.normal[0] * k.normal * length, s.normal[1] * k.normal * length, css("--normal"));
        bar(at, s.normal[1] * k.friction * length, -s.normal[0] * k.friction * length, css("--friction"));
        c.beginPath();
        c.arc(at[0], at[1], 5, 0, 7);
        c.fillStyle = css("--text");
        c.fill();
      }
      const hand = v.to([m.hand_x[row], m.hand_y[row]]);
      c.beginPath();
      c.arc(hand[0], hand[1], 7, 0, 7);
      c.fillStyle = css("--hand");
      c.fill();
    };
  };
})();
