// What a person is shown of themselves when the session is over. It stays when the server is gone.

/** @param {string} id */
const find = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** Show a person's own page over everything else. @param {string} address on this server */
export function showOwnPage(address) {
  const frame = /** @type {HTMLIFrameElement} */ (find("own-page-frame"));
  if (frame.getAttribute("src") === address) return;
  frame.src = address;
  find("own-page").classList.remove("hidden");
  find("own-page-save").onclick = () => save(frame);
  find("own-page-print").onclick = () => frame.contentWindow?.print();
}

/** Save the page as a file. @param {HTMLIFrameElement} frame */
function save(frame) {
  const text = `<!doctype html>\n${frame.contentDocument?.documentElement.outerHTML ?? ""}`;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/html" }));
  link.download = "my-session.html";
  link.click();
  URL.revokeObjectURL(link.href);
}
