// Images: which level of time, how bright, how near; all images of a scene move together.
function levels(section) {
    const choose = () => {
        const level = chosen(section, "level") ?? "0";
        all(section, ".strip").forEach((strip) => strip.toggleAttribute("hidden", strip.dataset.level !== level));
    };
    // The reference is inlined once.
    const reference = one(section, ".strip .source");
    all(section, ".again").forEach((image) => (image.src = reference.src));
    all(section, 'input[name^="level-"]').forEach((input) => input.addEventListener("change", choose));
    choose();
}

// Replaces the table that leads from an inlined byte to sRGB.
function exposure(section) {
    const slider = one(section, ".exposure");
    const encoded = (light) => (light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055);
    slider.addEventListener("input", () => {
        const stops = Number(slider.value);
        const gain = data.headroom * 2 ** stops;
        const table = Array.from({ length: 256 }, (_, byte) => encoded(Math.min(gain * (byte / 255) ** 3, 1)).toFixed(4));
        all(section, ".tones feComponentTransfer > *").forEach((part) => part.setAttribute("tableValues", table.join(" ")));
        const sign = stops > 0 ? "+" : stops < 0 ? "−" : "±";
        slider.nextElementSibling.textContent = `${sign}${Math.abs(stops)} EV`;
    });
}

const MOST_ZOOM = 64;

function zoom(section) {
    const images = one(section, ".images");
    const told = one(section, ".zoom output");
    let [near, left, top] = [1, 0, 0];

    function show() {
        [left, top] = [left, top].map((edge) => clamp(edge, 0, 1 - 1 / near));
        images.style.setProperty("--zoom", near);
        images.style.setProperty("--left", left);
        images.style.setProperty("--top", top);
        images.classList.toggle("zoomed", near > 1);
        told.textContent = `${Math.round(near * 10) / 10}×`;
        sharpen(images, near);
    }

    // About the place at these shares of what is seen, which stays where it is.
    function by(factor, x = 0.5, y = 0.5) {
        const next = clamp(near * factor, 1, MOST_ZOOM);
        [left, top] = [left + x / near - x / next, top + y / near - y / next];
        near = next;
        show();
    }

    function move(x, y) {
        [left, top] = [left + x / near, top + y / near];
        show();
    }

    const share = (view, event) => {
        const box = view.getBoundingClientRect();
        return [(event.clientX - box.x) / box.width, (event.clientY - box.y) / box.height];
    };
    for (const view of all(images, ".view")) {
        view.addEventListener("wheel", (event) => {
            if (near === 1 && !event.ctrlKey && !event.metaKey) return;
            event.preventDefault();
            by(Math.exp(-clamp(event.deltaY, -60, 60) / 100), ...share(view, event));
        }, { passive: false });
        grab(view, {
            moves: () => near > 1,
            drag: (x, y) => move(-x, -y),
            click: (event) => view.matches(".stage") || by(event.shiftKey ? 0.5 : 2, ...share(view, event)),
        });
    }
    for (const button of all(section, "[data-zoom]")) {
        button.addEventListener("click", () => by(Number(button.dataset.zoom)));
    }
    images.addEventListener("keydown", (event) => {
        if (event.target.matches("input, select, button") || event.ctrlKey || event.metaKey) return;
        const pans = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
        const zooms = { "+": 2, "=": 2, "-": 0.5, 0: 0, Escape: 0 };
        if (event.key in zooms) by(zooms[event.key]);
        else if (event.key in pans && near > 1) move(...pans[event.key]);
        else return;
        event.preventDefault();
    });
    addEventListener("resize", () => sharpen(images, near));
    show();
}

// Enlarged pixels keep their edges; only where images are made smaller they are smoothed.
function sharpen(images, near) {
    const view = one(images, ".strip:not([hidden]) .view");
    const across = view.clientWidth * near * devicePixelRatio;
    images.classList.toggle("small", across < one(view, "img").naturalWidth);
}

// A pointer on a view: a drag where that means something, else a click.
function grab(view, { moves, drag, click }) {
    let from = null;
    view.addEventListener("pointerdown", (event) => {
        if (event.button === 0 && !event.defaultPrevented) from = { x: event.clientX, y: event.clientY, dragged: false };
    });
    view.addEventListener("pointermove", (event) => {
        if (!from || event.defaultPrevented) return;
        const [x, y] = [event.clientX - from.x, event.clientY - from.y];
        if (!from.dragged && Math.hypot(x, y) < 4) return;
        from.dragged = true;
        if (!moves()) return;
        view.setPointerCapture(event.pointerId);
        drag(x / view.clientWidth, y / view.clientHeight);
        [from.x, from.y] = [event.clientX, event.clientY];
    });
    view.addEventListener("pointerup", (event) => {
        if (from && !from.dragged) click(event);
        from = null;
    });
    view.addEventListener("pointercancel", () => (from = null));
}
