// Bundles the page into the folder that is given, by default where `hthor live` looks for it.
import { copyFileSync, mkdirSync, rmSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "..", "hthor", "live", "page");

rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });
await build({
  entryPoints: {
    page: join(here, "src", "main.js"),
    socket: join(here, "src", "socket_worker.js"),
    experimenter: join(here, "src", "experimenter.js"),
    emulation: join(here, "src", "headset", "emulation.js"),
  },
  outdir: out,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "linked",
  logLevel: "warning",
});
for (const name of ["index.html", "page.css", "experimenter.html", "experimenter.css", "icon.svg"]) copyFileSync(join(here, "src", name), join(out, name));
