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
    time = Math.min(Math.max(time, first), last);
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
