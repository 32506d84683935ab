// What is wider than its place scrolls by keys as well.
addEventListener("load", () => document.querySelectorAll("article :is(pre, div.math, table.docutils)").forEach((wide) => {
  if (wide.scrollWidth > wide.clientWidth) wide.tabIndex = 0;
}));
