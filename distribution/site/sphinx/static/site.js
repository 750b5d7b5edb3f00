// Listings and tables that are wider than the page can be scrolled with the keyboard.
// Pictures open alone, where they can be as large as they are.
document.addEventListener("DOMContentLoaded", () => {
  for (const picture of document.querySelectorAll(".content p > img")) {
    const link = document.createElement("a");
    link.href = picture.src;
    link.className = ["only-light", "only-dark"].filter((name) => picture.classList.contains(name)).join(" ");
    picture.replaceWith(link);
    link.append(picture);
  }
  for (const box of document.querySelectorAll("pre, .table-wrapper")) {
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
  }
});
