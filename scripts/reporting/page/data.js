// The data of a table, which stand packed in the link that saves them.

/** The text of the table behind a link, which is a data URI. */
export async function textOf(link) {
  const letters = atob(link.href.slice(link.href.indexOf(",") + 1));
  const packed = new Blob([Uint8Array.from(letters, (letter) => letter.charCodeAt(0))]).stream();
  return new Response(packed.pipeThrough(new DecompressionStream("gzip"))).text();
}

/** The cells of a line; double quotes are around those with a comma. */
function cellsOf(line) {
  if (!line.includes('"')) return line.split(",");
  return line.split(/,(?=(?:[^"]*"[^"]*")*[^"]*$)/).map((cell) => cell.replaceAll('"', ""));
}

/** Columns of numbers by their names, from the text of a table. */
export function columnsOf(text, names) {
  const lines = text.split("\n").filter((line) => line && !line.startsWith("#"));
  const places = cellsOf(lines[0]);
  const wanted = names.map((name) => places.indexOf(name));
  const columns = names.map(() => new Float64Array(lines.length - 1));
  for (let row = 1; row < lines.length; row += 1) {
    const cells = cellsOf(lines[row]);
    for (let k = 0; k < names.length; k += 1) columns[k][row - 1] = Number(cells[wanted[k]]);
  }
  return Object.fromEntries(names.map((name, k) => [name, columns[k]]));
}

/** Have a link save its table as plain text, by its own name. */
export function bindDownload(link) {
  link.addEventListener("click", async (event) => {
    event.preventDefault();
    const file = new Blob([await textOf(link)], { type: "text/csv" });
    const address = URL.createObjectURL(file);
    const save = Object.assign(document.createElement("a"), { href: address, download: link.dataset.name });
    save.click();
    setTimeout(() => URL.revokeObjectURL(address), 60000);
  });
}
