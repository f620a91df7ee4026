// Stand-ins for what a browser has: a canvas to write on, and a headset.

// what the sheets draw on, and the browser's headset: stand-ins, as there is no browser here
const pen = new Proxy({}, { get: (_, name) => (name === "measureText" ? () => ({ width: 10 }) : () => {}), set: () => true });
globalThis.document = { createElement: () => ({ getContext: () => pen }) };

class Session extends EventTarget {
  constructor(spaces) {
    super();
    this.spaces = spaces;
    this.inputSources = [];
    this.visibilityState = "visible";
  }

  async requestReferenceSpace(kind) {
    if (!this.spaces.includes(kind)) throw new Error("NotSupportedError");
    return new EventTarget();
  }

  async end() {
    this.dispatchEvent(new Event("end"));
  }
}

/** A renderer whose session is one that `navigator.xr` gives. */
export function stage(spaces = ["local-floor", "local", "viewer"], refuse = "") {
  let space = new EventTarget();
  const xr = { enabled: false, setReferenceSpaceType: (kind) => (xr.kind = kind), getReferenceSpace: () => space };
  xr.setSession = async () => {
    if (refuse === "renderer") throw new Error("no layer");
    space = new EventTarget();
  };
  const ended = [];
  const given = {
    requestSession: async () => {
      if (refuse === "browser") throw new Error("no headset");
      const session = new Session(spaces);
      session.addEventListener("end", () => ended.push(session));
      return session;
    },
  };
  Object.defineProperty(globalThis, "navigator", { value: { xr: given }, configurable: true });
  return { renderer: { xr }, ended };
}
