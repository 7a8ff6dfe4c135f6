// Two images, one over the other up to a line that can be moved.
function compare(section) {
    const stage = one(section, ".stage");
    const cut = one(section, ".cut");
    const sources = all(section, "img.source");
    // At first the first contender's last image, and the second's or the reference.
    const images = all([...all(section, ".strip")].pop(), "img.source:not([data-kind])");
    const latest = images.filter((image) => image.dataset.title !== "Reference").map((image) => sources.indexOf(image));
    const first = { left: latest[0], right: latest[1] ?? 0 };

    function show(side, index) {
        const source = sources[index];
        const layer = one(stage, `.layer.${side}`);
        layer.classList.toggle("tone", source.dataset.kind !== "map");
        const image = one(layer, "img");
        [image.src, image.alt] = [source.src, source.dataset.title];
        one(stage, `.label.${side}`).textContent = source.dataset.title;
    }

    for (const side of ["left", "right"]) {
        const select = one(section, `select.${side}`);
        sources.forEach((source, index) => select.add(new Option(source.dataset.title, index)));
        select.value = first[side];
        select.addEventListener("change", () => show(side, select.value));
        show(side, select.value);
    }

    const place = () => stage.style.setProperty("--cut", `${cut.value}%`);
    cut.addEventListener("input", place);
    place();

    // Where images are zoomed a drag moves them, but on the line itself.
    let held = false;
    const follow = (event) => {
        const box = stage.getBoundingClientRect();
        cut.value = (100 * (event.clientX - box.x)) / box.width;
        place();
    };
    stage.addEventListener("pointerdown", (event) => {
        const zoomed = one(section, ".images").classList.contains("zoomed");
        if (event.button !== 0 || (zoomed && !event.target.matches(".divider"))) return;
        held = true;
        event.preventDefault();
        stage.setPointerCapture(event.pointerId);
        follow(event);
    });
    stage.addEventListener("pointermove", (event) => {
        if (!held) return;
        event.preventDefault();
        follow(event);
    });
    for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => (held = false));
}
