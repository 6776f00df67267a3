// Zoom of the figures by their viewBox. Without this script the figures are simply not zoomed.
(function () {
  "use strict";
  var figures = document.querySelectorAll("figure > svg[viewBox]");
  figures.forEach(function (svg) {
    var whole = svg.getAttribute("viewBox").split(/\s+/).map(Number), box = whole.slice(), drag = null;
    function show() { svg.setAttribute("viewBox", box.join(" ")); svg.classList.toggle("zoomed", box[2] < whole[2]); }
    function reset() { box = whole.slice(); show(); }
    function inside(value, low, high) { return Math.min(Math.max(value, low), high); }
    function moveTo(x, y) {
      box[0] = inside(x, whole[0], whole[0] + whole[2] - box[2]);
      box[1] = inside(y, whole[1], whole[1] + whole[3] - box[3]);
      show();
    }
    function zoom(factor, fx, fy) {
      var width = inside(box[2] / factor, whole[2] / 50, whole[2]), height = width * whole[3] / whole[2];
      var x = box[0] + fx * (box[2] - width), y = box[1] + fy * (box[3] - height);
      box[2] = width; box[3] = height;
      moveTo(x, y);
    }
    svg.setAttribute("tabindex", "0");
    svg.addEventListener("wheel", function (event) {
      if (document.activeElement !== svg && !event.ctrlKey) { return; }
      event.preventDefault();
      var frame = svg.getBoundingClientRect();
      zoom(Math.exp(-0.002 * event.deltaY), (event.clientX - frame.left) / frame.width, (event.clientY - frame.top) / frame.height);
    }, { passive: false });
    svg.addEventListener("pointerdown", function (event) {
      if (event.button !== 0 || box[2] >= whole[2]) { return; }
      drag = { x: event.clientX, y: event.clientY, left: box[0], top: box[1] };
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener("pointermove", function (event) {
      if (!drag) { return; }
      var frame = svg.getBoundingClientRect();
      moveTo(drag.left - (event.clientX - drag.x) * box[2] / frame.width, drag.top - (event.clientY - drag.y) * box[3] / frame.height);
    });
    ["pointerup", "pointercancel"].forEach(function (name) { svg.addEventListener(name, function () { drag = null; }); });
    svg.addEventListener("dblclick", reset);
    svg.addEventListener("keydown", function (event) {
      var step = 0.15, keys = {
        "+": function () { zoom(1.4, 0.5, 0.5); }, "=": function () { zoom(1.4, 0.5, 0.5); },
        "-": function () { zoom(1 / 1.4, 0.5, 0.5); }, "0": reset, "Escape": reset,
        "ArrowLeft": function () { moveTo(box[0] - step * box[2], box[1]); },
        "ArrowRight": function () { moveTo(box[0] + step * box[2], box[1]); },
        "ArrowUp": function () { moveTo(box[0], box[1] - step * box[3]); },
        "ArrowDown": function () { moveTo(box[0], box[1] + step * box[3]); }
      }, act = keys[event.key];
      if (!act || event.ctrlKey || event.metaKey || event.altKey) { return; }
      if (event.key.indexOf("Arrow") === 0 && box[2] >= whole[2]) { return; }
      event.preventDefault();
      act();
    });
    window.addEventListener("beforeprint", reset);
  });
  var hint = document.getElementById("zoom-hint");
  if (hint && figures.length) { hint.hidden = false; }
})();
