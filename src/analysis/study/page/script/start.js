// Every scene on its own.
document.documentElement.classList.add("alive");
for (const section of all(document, ".scene")) {
    curves(section);
    levels(section);
    exposure(section);
    compare(section);
    zoom(section);
}
