// What the rest of the script is put together from.
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const one = (root, query) => root.querySelector(query);
const all = (root, query) => [...root.querySelectorAll(query)];
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const chosen = (root, name) => one(root, `input[name^="${name}-"]:checked`)?.value;
