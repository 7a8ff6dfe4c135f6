// Error curves: which measure, over what, whose, and the numbers of the point at hand.
function curves(section) {
    const series = data.scenes[section.dataset.scene];
    const frame = one(section, ".frame");
    const tip = one(frame, ".tip");
    const charts = all(frame, ".chart");
    const shown = () => charts.find((chart) => !chart.hasAttribute("hidden"));
    let at = null;

    function choose() {
        const [measure, axis] = [chosen(section, "measure"), chosen(section, "axis")];
        for (const chart of charts) {
            const wanted = chart.dataset.measure === measure && chart.dataset.axis === axis;
            chart.toggleAttribute("hidden", !wanted);
        }
        one(frame, ".up").textContent = data.measures[measure].name;
        one(frame, ".across").textContent = data.axes[axis];
        one(section, ".slope").textContent = data.measures[measure].slope;
        one(section, ".own")?.toggleAttribute("hidden", measure !== "relmse");
        leave();
    }

    // Marks of contenders that are not hidden, with the middle of each on the screen.
    function marks() {
        const groups = all(shown(), ".series:not(.off)");
        return groups.flatMap((group) => [...one(group, ".marks").children].map((mark, point) => {
            const box = mark.getBoundingClientRect();
            const middle = [box.x + box.width / 2, box.y + box.height / 2];
            return { mark, middle, series: Number(group.dataset.series), point };
        }));
    }

    function leave() {
        all(frame, ".near").forEach((mark) => mark.classList.remove("near"));
        tip.hidden = true;
        at = null;
    }

    function tell(found) {
        leave();
        at = found;
        found.mark.classList.add("near");
        const whose = series[found.series];
        const point = whose.points[found.point];
        const measure = data.measures[shown().dataset.measure].name;
        const name = document.createElement("b");
        name.textContent = whose.name;
        const lines = [`${point.seconds}, ${point.samples}`, `${measure} ${point[shown().dataset.measure]}`];
        tip.replaceChildren(name, ...lines.flatMap((line) => [document.createElement("br"), line]));
        tip.hidden = false;
        const box = frame.getBoundingClientRect();
        const [x, y] = [found.middle[0] - box.x, found.middle[1] - box.y];
        tip.style.left = `${clamp(x - tip.offsetWidth / 2, 0, Math.max(box.width - tip.offsetWidth, 0))}px`;
        tip.style.top = `${y < tip.offsetHeight + 16 ? y + 14 : y - tip.offsetHeight - 14}px`;
    }

    function hover(event) {
        const away = (found) => Math.hypot(found.middle[0] - event.clientX, found.middle[1] - event.clientY);
        const nearest = marks().reduce((best, found) => (!best || away(found) < away(best) ? found : best), null);
        nearest && away(nearest) < 40 ? tell(nearest) : leave();
    }

    function step(event) {
        const moves = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] };
        if (event.key === "Escape") return leave();
        const move = moves[event.key];
        const found = marks();
        if (!move || !found.length) return;
        event.preventDefault();
        if (!at) return tell(found[0]);
        const names = [...new Set(found.map((mark) => mark.series))];
        const next = names[clamp(names.indexOf(at.series) + move[0], 0, names.length - 1)];
        const line = found.filter((mark) => mark.series === next);
        tell(line[clamp(at.point + move[1], 0, line.length - 1)]);
    }

    function toggle(button) {
        const pressed = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", pressed);
        const groups = all(frame, `[data-series="${button.dataset.series}"]`);
        groups.forEach((group) => group.classList.toggle("off", !pressed));
        leave();
    }

    all(section, ".plot input").forEach((input) => input.addEventListener("change", choose));
    all(section, ".legend button").forEach((button) => button.addEventListener("click", () => toggle(button)));
    frame.addEventListener("pointermove", hover);
    frame.addEventListener("pointerdown", hover);
    frame.addEventListener("pointerleave", leave);
    frame.addEventListener("blur", leave);
    frame.addEventListener("keydown", step);
    choose();
}
