"use strict";
// One cursor for all drawings over time, for the path and for the film.
(() => {
  const run = JSON.parse(document.getElementById("moments").textContent);
  const film = document.querySelector("video");
  const panels = [...document.querySelectorAll(".time .drawing")];
  const path = document.querySelector("[data-path] .drawing");
  const now = document.getElementById("now");
  const first = run.time[0], last = run.time[run.time.length - 1];
  let filmed = false;

  // Curves are scaled within the frame of their axes; numbers on the axis move along.
  const still = panels.map((drawing) => {
    const frame = drawing.querySelector("svg").viewBox.baseVal.width;
    const clipped = [...drawing.querySelectorAll("[clip-path]")].map((curve) => {
      const window = document.createElementNS("http://www.w3.org/2000/svg", "g");
      window.setAttribute("clip-path", curve.getAttribute("clip-path"));
      curve.removeAttribute("clip-path");
      curve.setAttribute("vector-effect", "non-scaling-stroke");
      curve.replaceWith(window);
      window.append(curve);
      return curve;
    });
    const axis = drawing.querySelector("[id^='matplotlib.axis_1']");
    const marks = [...axis.querySelectorAll("use, text")].map((mark) =>
      ({mark, x: Number(mark.getAttribute("x")), y: mark.getAttribute("y")}));
    return {drawing, frame, clipped, marks, whole: drawing.dataset.box.split(" ").map(Number)};
  });
  let from = first, to = last, present = first;

  function zoom() {
    for (const {drawing, frame, clipped, marks, whole} of still) {
      const [left, top, right, bottom, begin, end, low, high] = whole;
      const scale = (end - begin) / (to - from);
      const start = frame * left, wide = frame * (right - left);
      const shift = start - scale * (start + wide * (from - begin) / (end - begin));
      for (const curve of clipped)
        curve.setAttribute("transform", `translate(${shift} 0) scale(${scale} 1)`);
      for (const {mark, x} of marks) {
        const at = shift + scale * x;
        mark.setAttribute("x", at);
        mark.removeAttribute("transform");
        mark.style.display = at < start - 1 || at > start + wide + 1 ? "none" : "";
      }
      drawing.dataset.box = [left, top, right, bottom, from, to, low, high].join(" ");
    }
    const whole = from === first && to === last;
    document.body.classList.toggle("zoomed", 3 * (to - from) < last - first);
    document.querySelector("#zoom span").textContent =
      whole ? "" : `shown: ${from.toFixed(2)} to ${to.toFixed(2)} s`;
  }

  function look(middle, span) {
    span = Math.min(span, last - first);
    from = Math.min(Math.max(middle - span / 2, first), last - span);
    to = from + span;
    zoom();
  }

  for (const button of document.querySelectorAll("#zoom button"))
    button.addEventListener("click", () => {
      const by = Number(button.dataset.by);
      look(present, by ? (to - from) / by : last - first);
      show(present);
    });

  const box = (drawing) => drawing.dataset.box.split(" ").map(Number);
  const percent = (share) => `${100 * share}%`;

  function row(time) {
    let low = 0, high = run.time.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (run.time[middle] < time) low = middle + 1; else high = middle;
    }
    return low;
  }

  function show(time) {
    present = time = Math.min(Math.max(time, first), last);
    if (time < from || time > to) look(time, to - from);
    for (const drawing of panels) {
      const [left, top, right, bottom, from, to] = box(drawing);
      const style = drawing.querySelector(".cursor").style;
      style.display = "block";
      style.left = percent(left + (right - left) * (time - from) / (to - from));
      style.top = percent(top);
      style.height = percent(bottom - top);
    }
    const i = row(time);
    if (path) {
      const [left, top, right, bottom, west, east, south, north] = box(path);
      const style = path.querySelector(".dot").style;
      style.display = "block";
      style.left = percent(left + (right - left) * (run.x[i] - west) / (east - west));
      style.top = percent(bottom - (bottom - top) * (run.y[i] - south) / (north - south));
    }
    const margin = run.margin[i] === null ? "none" : `${run.margin[i].toFixed(1)} mm`;
    const off = run.off[i] === null ? "?" : `${run.off[i].toFixed(2)} mm`;
    now.textContent = `${time.toFixed(2)} s: ${run.phases[run.phase[i]]}; ` +
      `margin ${margin}; ${off} off the ${run.best} prediction`;
    document.body.dataset.time = time.toFixed(3);
  }

  function point(drawing, event) {
    const frame = drawing.getBoundingClientRect();
    const [left, , right, , from, to] = box(drawing);
    const share = (event.clientX - frame.left) / frame.width;
    const time = from + (to - from) * (share - left) / (right - left);
    show(time);
    if (filmed) film.currentTime = Math.max(0, (time - run.begins) / run.playback);
  }

  for (const drawing of panels) {
    drawing.addEventListener("pointerdown", (event) => point(drawing, event));
    drawing.addEventListener("pointermove", (event) => {
      if (event.buttons) point(drawing, event);
    });
  }
  if (film) {
    const missing = document.getElementById("missing");
    const arrived = () => {
      filmed = true;
      film.hidden = false;
      missing.hidden = true;
      document.body.dataset.film = "shown";
    };
    const failed = () => {
      film.hidden = true;
      missing.hidden = false;
      document.body.dataset.film = "missing";
    };
    film.addEventListener("loadedmetadata", arrived);
    film.addEventListener("error", failed);
    if (film.readyState > 0) arrived();
    if (film.error) failed();
    const follow = () => show(run.begins + film.currentTime * run.playback);
    film.addEventListener("timeupdate", follow);
    film.addEventListener("play", () => {
      const step = () => { follow(); if (!film.paused) requestAnimationFrame(step); };
      step();
    });
  }
  show(first);
})();
