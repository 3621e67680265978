// Pictures and films of the stage, as files to keep.

const KINDS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];
const FRAMES = 60; // a second
const BITS = 8e6; // a second
const SLICE = 200; // milliseconds of film in a piece
const PATIENCE = 5000; // milliseconds until a film without any picture ends

/** Have the browser save what is at an address. */
export function save(address, name) {
  const link = Object.assign(document.createElement("a"), { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}

/** Whether the browser can film a canvas. */
export function canFilm() {
  return typeof MediaRecorder === "function" && KINDS.some((kind) => MediaRecorder.isTypeSupported(kind))
    && typeof HTMLCanvasElement.prototype.captureStream === "function";
}

/** Film a canvas until `stop` is called, which resolves with the film. */
export function film(canvas) {
  const stream = canvas.captureStream(FRAMES);
  const mimeType = KINDS.find((kind) => MediaRecorder.isTypeSupported(kind));
  const recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: BITS });
  const pieces = [];
  const begun = new Promise((resolve) => {
    recorder.addEventListener("dataavailable", ({ data }) => {
      pieces.push(data);
      if (data.size > 0) resolve();
    });
    setTimeout(resolve, PATIENCE);
  });
  const done = new Promise((resolve) => {
    recorder.addEventListener("stop", () => resolve(new Blob(pieces, { type: "video/webm" })));
  });
  recorder.start(SLICE);
  return {
    async stop() {
      await begun; // a film that ended before its first picture would have none
      if (recorder.state !== "inactive") recorder.stop();
      for (const track of stream.getTracks()) track.stop();
      return done;
    },
  };
}
