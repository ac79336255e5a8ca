// Stands in the head of limber's page, before viser's program: tells the server that the page lives, how large it is, what was typed
// and which of limber's own buttons was pressed (limber/monitor/page_link.py), and draws no more often than the machine can bear.
"use strict";
(() => {
  const PROTOCOL = "limber-page";
  const BEAT_MS = 50, HELLO_MS = 250, AGAIN_MS = 500;
  const FRAMES = {graphics_card: 30, software: 5}; // a second
  const SOFTWARE_SCALE = "0.5"; // a quarter of the pixels: all that a processor can draw beside an arm

  const software = (() => {
    const gl = document.createElement("canvas").getContext("webgl2");
    if (!gl) return true;
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    const name = info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
    gl.getExtension("WEBGL_lose_context")?.loseContext();
    return /swiftshader|llvmpipe|softpipe|software/i.test(name);
  })();

  // --- resolution of the arm: viser reads it from the address
  const address = new URL(location);
  if (software !== address.searchParams.has("fixedDpr")) {
    if (software) address.searchParams.set("fixedDpr", SOFTWARE_SCALE);
    else address.searchParams.delete("fixedDpr"); // of a copied address
    history.replaceState(null, "", address);
  }

  // --- frames: whoever draws again and again is called no more often than this
  const period = 1000 / (software ? FRAMES.software : FRAMES.graphics_card);
  const nextFrame = window.requestAnimationFrame.bind(window), cancelFrame = window.cancelAnimationFrame.bind(window);
  const called = new WeakMap(), waiting = new Map();
  let frames = 0;
  window.requestAnimationFrame = callback => {
    const number = ++frames;
    const draw = now => {
      waiting.delete(number);
      called.set(callback, performance.now());
      callback(now);
    };
    const left = period - (performance.now() - (called.get(callback) ?? -Infinity));
    const start = () => waiting.set(number, {frame: nextFrame(draw)});
    if (left > 2) waiting.set(number, {timer: setTimeout(start, left)});
    else start();
    return number;
  };
  window.cancelAnimationFrame = number => {
    const entry = waiting.get(number);
    if (!entry) return;
    waiting.delete(number);
    if (entry.frame) cancelFrame(entry.frame);
    else clearTimeout(entry.timer);
  };

  // --- the way to the server
  const viewer = () => Number([...document.querySelectorAll("[data-limber-viewer]")].pop()?.dataset.limberViewer ?? NaN);
  let socket = null;
  function open() {
    socket = new WebSocket(location.origin.replace(/^http/, "ws"), PROTOCOL);
    socket.onclose = () => setTimeout(open, AGAIN_MS);
  }
  function tell(kind, value) {
    const number = viewer();
    if (Number.isNaN(number) || socket?.readyState !== WebSocket.OPEN) return false;
    socket.send(JSON.stringify({viewer: number, kind, value}));
    return true;
  }
  let told = "";
  function hello() {
    const size = {width: innerWidth, height: innerHeight, software};
    const now = `${viewer()} ${socket?.readyState} ${JSON.stringify(size)}`;
    if (now !== told && tell("size", size)) told = now;
  }
  open();
  setInterval(hello, HELLO_MS);

  // --- a sign of life while a mouse button is down: from this thread, and only if the browser's own process answers
  let down = false, asking = false;
  async function beat() {
    if (!down || document.hidden || asking) return;
    asking = true;
    try {
      await navigator.locks?.query();
    } catch {
      // without locks this thread alone vouches
    }
    asking = false;
    if (down) tell("alive", {software});
  }
  addEventListener("pointerdown", () => { down = true; beat(); }, true);
  for (const end of ["pointerup", "pointercancel", "pagehide"]) addEventListener(end, () => { down = false; }, true);
  setInterval(beat, BEAT_MS);

  // --- buttons in limber's own boxes; a box that was drawn anew while the mouse was down is still the same button
  const word = event => event.target.closest?.("button[data-limber]:not([disabled])")?.dataset.limber;
  let pressed;
  addEventListener("pointerdown", event => { pressed = word(event); }, true);
  addEventListener("mousedown", event => { if (word(event)) event.preventDefault(); }, true); // the space bar stays STOP
  addEventListener("pointerup", event => {
    if (pressed && pressed === word(event)) tell("press", pressed);
    pressed = undefined;
  }, true);
  addEventListener("keydown", event => {
    if (event.key === "Enter" && word(event)) tell("press", word(event));
    if (event.key === " " && word(event)) event.target.blur();
  }, true);
  addEventListener("keyup", event => { if (event.key === " " && word(event)) event.preventDefault(); }, true);

  // --- a number box: what is typed stays until Enter or another field, whatever arrives meanwhile
  const FIELD = "input.mantine-NumberInput-input";
  function sliderOf(field) {
    const box = field.closest(".mantine-NumberInput-root")?.parentElement;
    return box?.querySelector(".mantine-Slider-root[id]")?.id;
  }
  function edit(field, slider) {
    const own = document.createElement("input"), style = getComputedStyle(field);
    own.className = "limber-typed";
    own.inputMode = "decimal";
    own.value = field.value;
    own.setAttribute("aria-label", "value");
    own.place = () => {
      const {left, right, top, width, height} = field.getBoundingClientRect();
      Object.assign(own.style, {
        left: `${left + 84 > innerWidth ? right - 84 : left}px`, top: `${top}px`,
        width: `${Math.max(width, 84)}px`, height: `${height}px`, font: style.font, padding: style.padding,
      });
    };
    own.place();
    let over = false;
    const end = send => {
      if (over) return;
      if (send && own.value.trim() !== field.value && !tell("typed", {slider, text: own.value.slice(0, 100)})) {
        own.setCustomValidity("not sent: no connection to limber monitor");
        own.reportValidity();
        return;
      }
      over = true;
      own.remove();
    };
    own.onkeydown = event => {
      event.stopPropagation();
      if (event.key === "Enter") end(true);
      if (event.key === "Escape") end(false);
    };
    // The number box takes the focus whenever its value changes: that is nobody who has typed.
    own.onblur = event => { if (event.relatedTarget !== field) end(true); };
    own.field = field;
    document.body.append(own);
    own.focus();
    own.select();
  }
  addEventListener("focusin", event => {
    const slider = event.target.matches?.(FIELD) && sliderOf(event.target);
    const own = document.querySelector(".limber-typed");
    if (own?.field === event.target) own.focus();
    else if (slider) edit(event.target, slider);
  }, true);
  addEventListener("scroll", event => {
    if (!event.target.matches?.(".limber-typed")) document.querySelector(".limber-typed")?.place();
  }, true);

  // --- viser's note on a missing graphics card covers the arm; limber's own is a line in the panel
  new MutationObserver(() => {
    for (const note of document.querySelectorAll(".mantine-Notification-root:not([hidden])"))
      if (note.textContent.startsWith("Software WebGL rendering detected")) note.hidden = true;
  }).observe(document, {childList: true, subtree: true});
})();
