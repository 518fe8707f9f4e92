// Job files: opened, dropped on the page, and copied from it.

const at = (id) => document.getElementById(id);

/** Calls take(text, name) with each file that the user opens or drops, refuse(message) if it cannot be read. */
export function listenForFiles(take, refuse) {
  const open = async (file) => {
    if (!file) return;
    try {
      take(await file.text(), file.name);
    } catch (error) {
      if (!(error instanceof DOMException)) throw error;
      refuse(`${file.name}: cannot be read: ${error.message}`); // a directory, for example
    }
  };
  at("open").onclick = () => at("file").click();
  at("file").onchange = () => {
    open(at("file").files[0]);
    at("file").value = ""; // so that the same file can be opened again
  };
  const mark = (isDropping) => document.body.classList.toggle("dropping", isDropping);
  document.addEventListener("dragover", (event) => {
    event.preventDefault();
    mark(true);
  });
  document.addEventListener("dragleave", () => mark(false));
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    mark(false);
    open(event.dataTransfer.files[0]);
  });
}

/** Puts the text of a job on the clipboard, and shows it. */
export function copy(text) {
  at("jobtext").value = text;
  at("copied").textContent = "Select and copy the text:";
  navigator.clipboard?.writeText(text)
    .then(() => { at("copied").textContent = "The text is on the clipboard:"; }, () => {});
  at("dialog").showModal();
  at("jobtext").select();
}
