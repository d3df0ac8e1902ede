"use strict";
// Tables sort by the column whose head is pressed: numbers as numbers, empty cells last; again for the other way.
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  const rows = table.tBodies[0];
  heads.forEach((head, column) => head.firstElementChild.addEventListener("click", () => {
    const up = head.getAttribute("aria-sort") !== "ascending";
    const text = row => row.cells[column].textContent;
    const order = (a, b) => {
      const x = text(a), y = text(b);
      if (x === "" || y === "") return (x === "") - (y === "");
      const numbers = x - y;
      return (Number.isNaN(numbers) ? x.localeCompare(y, "en", {numeric: true}) : numbers) * (up ? 1 : -1);
    };
    rows.append(...[...rows.rows].sort(order));
    for (const each of heads) each.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", up ? "ascending" : "descending");
  }));
}
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach(each => { each.open = true; }));
