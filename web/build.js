// Bundles the page into the folder that is given, by default where `hthor live` looks for it.
import { copyFileSync, mkdirSync, rmSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "..", "hthor", "live", "page");

rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });
const common = { outdir: out, bundle: true, minify: true, target: "es2022", logLevel: "warning" };
await build({
  ...common,
  entryPoints: {
    page: join(here, "src", "main.js"),
    socket: join(here, "src", "socket_worker.js"),
    experimenter: join(here, "src", "experimenter.js"),
    emulation: join(here, "src", "headset", "emulation.js"),
  },
  format: "esm",
  legalComments: "linked",
});
// One file with everything in it, which also works where it is opened from a folder.
await build({
  ...common,
  entryPoints: { watch: join(here, "src", "watch", "watch.js") },
  format: "iife",
  charset: "ascii",
  legalComments: "eof",
});
const copied = ["index.html", "page.css", "experimenter.html", "experimenter.css", "icon.svg"];
for (const name of [...copied, "watch/watch.html", "watch/watch.css"]) {
  copyFileSync(join(here, "src", name), join(out, basename(name)));
}
