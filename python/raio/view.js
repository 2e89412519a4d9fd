// Draws the frames of python/raio/_live.py to a canvas, and sends the mouse's gestures.
const CLICK = 4; // pixels that a click may move
const PAUSE = 60; // between gestures that no frame acknowledges, ms

function render({ model, el }) {
  const [width, height] = model.get("_size");
  const box = document.createElement("div");
  box.className = "raio-view";
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  canvas.title = "Drag turns, wheel zooms, right or shift-drag moves, double click resets";
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "Rendered scene. " + canvas.title);
  const bar = document.createElement("div");
  bar.className = "raio-bar";
  const text = document.createElement("div");
  text.className = "raio-text";
  text.setAttribute("role", "status");
  box.append(canvas, bar, text);
  el.append(box);
  const context = canvas.getContext("2d");
  const end = new AbortController();
  const listen = (name, call, more = {}) =>
    canvas.addEventListener(name, call, { signal: end.signal, ...more });

  // --- frames

  const draw = async (bytes) => {
    const picture = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    context.clearRect(0, 0, width, height);
    context.imageSmoothingQuality = "high";
    context.drawImage(picture, 0, 0, width, height);
    picture.close();
  };
  const say = (words, isError) => {
    text.textContent = words;
    text.classList.toggle("raio-error", isError);
  };
  let waiting = []; // gestures that were not sent yet; alike ones are added up
  let timer = 0;
  let sent = 0;
  const receive = async (message, buffers) => {
    if (message.type === "stage") say(message.text, false);
    if (message.type === "error") say(message.text, true);
    if (message.type !== "frame") return;
    try {
      await draw(buffers[0]);
      say("", false);
    } catch (error) {
      say(String(error), true);
    }
    const done = message.moving ? 1 : message.samples / message.of;
    bar.style.width = done < 1 ? 100 * done + "%" : "0";
    canvas.dataset.frame = message.frame;
    canvas.dataset.samples = message.moving ? 0 : message.samples;
    // One message instead of many: each costs the page and the kernel some milliseconds.
    const gestures = waiting;
    waiting = [];
    clearTimeout(timer);
    timer = 0;
    if (gestures.length) sent = performance.now();
    model.send({ type: "ack", frame: message.frame, gestures });
  };
  model.on("msg:custom", receive);
  // The picture of a notebook that is shown without Python, too.
  const still = model.get("_still");
  if (still && still.byteLength) draw(still).catch(() => {});

  // --- gestures

  const flush = () => {
    timer = 0;
    sent = performance.now();
    for (const gesture of waiting) model.send(gesture);
    waiting = [];
  };
  const push = (gesture) => {
    const last = waiting[waiting.length - 1];
    if (last && last.type === gesture.type && gesture.type !== "reset") {
      for (const key of ["dx", "dy", "steps"]) if (key in gesture) last[key] += gesture[key];
    } else {
      waiting.push(gesture);
    }
    if (!timer) timer = setTimeout(flush, Math.max(0, PAUSE - (performance.now() - sent)));
  };

  let drag = null;
  listen("pointerdown", (event) => {
    if (drag || event.button > 2) return;
    const pans = event.button !== 0 || event.shiftKey;
    drag = { type: pans ? "pan" : "turn", x: event.clientX, y: event.clientY, far: 0 };
    canvas.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  listen("pointermove", (event) => {
    if (!drag) return;
    const dx = event.clientX - drag.x;
    const dy = event.clientY - drag.y;
    drag.x = event.clientX;
    drag.y = event.clientY;
    drag.far += Math.hypot(dx, dy);
    if (drag.far <= CLICK) return;
    push({ type: drag.type, dx, dy, height: canvas.clientHeight });
  });
  for (const name of ["pointerup", "pointercancel"]) listen(name, () => (drag = null));
  listen("contextmenu", (event) => event.preventDefault());
  listen("dblclick", () => push({ type: "reset" }));

  // A page that is being scrolled goes on scrolling when a picture comes under the mouse.
  let wheel = { time: -1e9, inside: false };
  document.addEventListener(
    "wheel",
    (event) => {
      const isNew = event.timeStamp - wheel.time > 300;
      const inside = isNew ? event.composedPath()[0] === canvas : wheel.inside;
      wheel = { time: event.timeStamp, inside };
    },
    { signal: end.signal, capture: true, passive: true },
  );
  listen(
    "wheel",
    (event) => {
      if (!wheel.inside || event.ctrlKey) return;
      event.preventDefault();
      event.stopPropagation();
      const unit = [100, 3, 1][event.deltaMode];
      const frame = canvas.getBoundingClientRect();
      push({
        type: "zoom",
        x: (event.clientX - frame.left) / frame.width,
        y: (event.clientY - frame.top) / frame.height,
        steps: -event.deltaY / unit,
      });
    },
    { passive: false },
  );

  try {
    model.send({ type: "hello" });
  } catch {
    // A page without Python shows the still picture.
  }
  return () => {
    end.abort();
    clearTimeout(timer);
    model.off("msg:custom", receive);
    box.remove();
  };
}

export default { render };
