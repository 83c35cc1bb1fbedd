/* Copyright 2026 quad_ident_ros contributors
   SPDX-License-Identifier: Apache-2.0 */

// Draws the pictures of a page again, from the values beside them, so that they can be zoomed,
// turned and read. The picture in the file, without scripts, stays for print.
'use strict';
(() => {
  const HEIGHT = 150, KEY_ZOOM = 1.5, LEAST = 4;  // px; times; values that a zoom shows at least
  const TURN = 5, DRAG = 0.5;             // degrees per key, and per px
  const NEAR = 24, MARGIN = 80;           // px to the pointer, and around the path together
  const redraws = [];

  const colour = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);

  function element(name, attributes, ...content) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...content);
    return made;
  }

  // What pictures over the same quantity (all of one flight) share: the span [first, last] that
  // they show, as places in their values, and the place of the cursor, null where there is none.
  const shared = {};
  function linked(quantity, count) {
    return shared[quantity] ??= {
      whole: [0, count - 1], span: [0, count - 1], at: null, keyed: false, follow: [],
      tell() { this.follow.forEach(one => one()); },
      zoom(first, last) {
        const middle = (first + last) / 2, half = Math.max(last - first, LEAST) / 2;
        const place = Math.min(Math.max(middle, half), Math.max(count - 1 - half, half));
        this.span = [Math.max(Math.round(place - half), 0),
                     Math.min(Math.round(place + half), count - 1)];
        this.tell();
      },
      scale(times) {
        const [first, last] = this.span, half = (last - first) / 2 / times;
        const middle = this.at ?? (first + last) / 2;
        this.zoom(middle - half, middle + half);
      },
      move(place) {
        this.at = Math.min(Math.max(place, 0), count - 1);
        const [first, last] = this.span, ahead = Math.max(this.at - last, 0);
        const back = Math.max(first - this.at, 0);
        this.span = [first + ahead - back, last + ahead - back];
        this.tell();
      },
      // What the pointer is over, null for nothing; a page that scrolls below a pointer that rests
      // does not take the place that keys have chosen.
      point(place, event) {
        if (this.keyed && !event?.movementX && !event?.movementY) return;
        this.keyed = false;
        if (place === this.at) return;
        if (place !== null) return this.move(place);
        this.at = null;
        this.tell();
      },
      reset() { this.zoom(...this.whole); },
    };
  }

  function keys(link, event) {
    const at = link.at ?? Math.round((link.span[0] + link.span[1]) / 2);
    const page = Math.max(1, Math.round((link.span[1] - link.span[0]) / 10));
    const actions = {
      ArrowRight: () => link.move(at + 1), ArrowLeft: () => link.move(at - 1),
      ArrowUp: () => link.move(at + 1), ArrowDown: () => link.move(at - 1),
      PageUp: () => link.move(at + page), PageDown: () => link.move(at - page),
      Home: () => link.move(link.span[0]), End: () => link.move(link.span[1]),
      '+': () => link.scale(KEY_ZOOM), '=': () => link.scale(KEY_ZOOM),
      '-': () => link.scale(1 / KEY_ZOOM), Escape: () => { link.at = null; link.reset(); },
    };
    if (actions[event.key]) link.keyed = true;
    act(actions[event.key], event);
  }

  function act(action, event) {
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  }

  function toolbar(name, actions, hint) {
    const bar = element('div', {class: 'tools', role: 'group', 'aria-label': name});
    for (const [label, does, action] of actions) {
      const button = element('button', {type: 'button', 'aria-label': does}, label);
      button.addEventListener('click', action);
      bar.append(button);
    }
    bar.append(element('span', {class: 'second', role: 'status'}, hint));
    return bar;
  }

  // Marks of an axis: 1, 2 and 5 times powers of ten; over many decades some five powers alone.
  function decades(low, high) {
    const places = [], steps = high / low > 300 ? [1] : [1, 2, 5];
    const each = Math.max(1, Math.ceil(Math.log10(high / low) / 5));
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += each) {
      for (const step of steps) places.push(Number(`${step}e${power}`));
    }
    return places.filter(place => place >= low && place <= high);
  }

  // ---- charts of lines ----

  function charts(data, live) {
    const link = linked(data.quantity, data.x.length);
    const hint = 'Drag to zoom, double-click for all; keys: arrows, + and -, Escape';
    const bar = toolbar(`Zoom over ${data.quantity}`, [
      ['+', 'Zoom in', () => link.scale(KEY_ZOOM)],
      ['\u2212', 'Zoom out', () => link.scale(1 / KEY_ZOOM)],
      ['All', 'Show all', () => link.reset()]], hint);
    const grid = element('div', {class: 'grid',
                                 style: `--columns: ${data.widths.map(w => `${w}fr`).join(' ')}`});
    live.append(bar, grid);
    const shows = data.panels.map(panel => chart(grid, data, panel, link));
    link.follow.push(() => {
      const [first, last] = link.span.map(place => data.x[place]);
      const all = link.span.every((place, end) => place === link.whole[end]);
      const said = all ? hint : `${data.quantity} ${first} to ${last} ${data.unit}`;
      if (bar.lastChild.textContent !== said) bar.lastChild.textContent = said;
      shows.forEach(show => show());
    });
  }

  function chart(grid, data, panel, link) {
    const head = element('p', {class: 'head'});
    const field = element('div', {class: 'field', tabindex: 0, role: 'slider', 'aria-valuemin': 0,
                                  'aria-valuemax': data.x.length - 1, 'aria-label':
                                  `${panel.title}, ${panel.unit}, over ${data.quantity}`});
    grid.append(element('div', {class: 'panel'}, head, field));
    const state = {quiet: false};   // while the chart follows, and does not lead
    const plot = new uPlot(options(data, panel, link, field, state),
                           [data.x, ...panel.lines.map(line => line.values)], field);
    plot.root.setAttribute('aria-hidden', 'true');  // the slider says what it shows
    const follow = action => { state.quiet = true; plot.batch(action); };
    const show = () => {
      const [min, max] = link.span.map(place => data.x[place]);
      const {scales} = plot;
      if (scales.x.min !== min || scales.x.max !== max) {
        follow(() => plot.setScale('x', {min, max}));
      }
      const left = link.at === null ? -10 : plot.valToPos(data.x[link.at], 'x');
      follow(() => plot.setCursor({left, top: left < 0 ? -10 : 0}));
      state.quiet = false;
      told(head, field, data, panel, link);
    };
    new ResizeObserver(() => {
      follow(() => plot.setSize({width: field.clientWidth, height: HEIGHT}));
      show();
    }).observe(field);
    redraws.push(() => plot.redraw(false, true));
    field.addEventListener('keydown', event => keys(link, event));
    field.addEventListener('pointerdown', () => { link.keyed = false; });
    told(head, field, data, panel, link);
    return show;
  }

  // Says the values at the cursor, or, where there is none, what each line spans in sight.
  function told(head, field, data, panel, {at, span: [first, last]}) {
    const time = at === null ? '' : `${data.x[at]} ${data.unit}`;
    const value = line => line.values[at] ?? 'none';
    const parts = panel.lines.map(line => element('span', {class: `key ${line.style}`},
      at === null ? line.label : `${line.style} ${value(line)}`));
    if (panel.band && at === null) parts.push(element('span', {class: 'key noise'}, data.band));
    head.replaceChildren(element('strong', {}, `${panel.title}, ${panel.unit}`),
                         time && `at ${time}`, ...parts);
    field.setAttribute('aria-valuenow', at ?? 0);
    const extent = ({values}) => {
      const seen = values.slice(first, last + 1).filter(one => one !== null);
      return seen.length ? `${Math.min(...seen)} to ${Math.max(...seen)}` : 'none';
    };
    const said = panel.lines.map(
      line => `${line.label} ${at === null ? extent(line) : value(line)}`);
    field.setAttribute('aria-valuetext', [time || 'no value chosen', ...said].join(', '));
  }

  function options(data, panel, link, field, state) {
    const log = data.logarithmic ? 3 : 1;
    const number = place => place && Math.abs(place) < 1e-3 ? place.toExponential()
      : +place.toPrecision(6);
    const plain = (places, unit) => places.map(place => `${number(place)}${unit}`);
    const axis = (unit, more) => ({
      stroke: () => colour('ink'), font: '12px system-ui, sans-serif',
      grid: {stroke: () => colour('grid'), width: 1},
      ticks: {stroke: () => colour('grid'), width: 1, size: 4},
      values: (_, places) => plain(places, unit),
      ...data.logarithmic && {filter: (_, places) => places,
                              splits: (_, side, low, high) => decades(low, high)}, ...more});
    return {
      width: field.clientWidth, height: HEIGHT, legend: {show: false}, padding: [6, 18, 0, 0],
      scales: {
        x: {time: false, distr: log, range: (_, low, high) => [low, high]},
        y: {distr: log, range: (_, low, high) => framed(low, high, panel, data.logarithmic)}},
      axes: [axis(` ${data.unit}`, {size: 24, space: 60}), axis('', {size: 52, space: 26})],
      series: [{}, ...panel.lines.map(line => ({
        stroke: () => colour(line.style), width: line.style === 'measured' ? 4 : 1.5,
        points: {show: false}, gaps: plot => data.breaks.map(place => [place - 1, place].map(
          end => plot.valToPos(data.x[end], 'x', true)))}))],
      cursor: {y: false, drag: {x: true, y: false, setScale: false},
               points: {size: 7}, bind: {dblclick: () => () => link.reset()}},
      hooks: {
        drawAxes: [plot => shaded(plot, panel.band)],
        setCursor: [plot => {
          if (state.quiet) return;
          link.point(plot.cursor.left < 0 ? null : plot.cursor.idx, plot.cursor.event);
        }],
        setSelect: [plot => {
          const {left, width} = plot.select;
          if (width > 0) link.zoom(plot.posToIdx(left), plot.posToIdx(left + width));
          plot.setSelect({left: 0, width: 0, top: 0, height: 0}, false);
        }],
      },
    };
  }

  // The range of what is in sight, with room, and no more than the limits of the panel.
  function framed(low, high, panel, logarithmic) {
    const [least, most] = panel.limits ?? [-Infinity, Infinity];
    if (logarithmic || low === null) return panel.limits ?? [-1, 1];
    [low, high] = [Math.max(Math.min(low, -(panel.band ?? -low)), least),
                   Math.min(Math.max(high, panel.band ?? high), most)];
    const room = 0.06 * (high - low) || Math.abs(high) || 1;
    return [low - room, high + room];
  }

  function shaded(plot, half) {
    if (!half) return;
    const [top, bottom] = [half, -half].map(value => plot.valToPos(value, 'y', true));
    const {left, width} = plot.bbox;
    plot.ctx.fillStyle = colour('noise');
    plot.ctx.fillRect(left, top, width, bottom - top);
  }

  // ---- the path of a flight in space ----

  function paths(data, live) {
    const link = linked('time', data.t.length), stages = Object.keys(data.errors);
    const sides = box(data.path);
    const where = at => data.path[at].map(value => value.toFixed(2)).join(', ');
    const most = Math.max(...stages.flatMap(stage => data.errors[stage])) || 1;
    const view = {azimuth: data.azimuth, elevation: data.elevation, size: 1};
    const home = {...view};
    const turn = (right, up) => {
      view.azimuth -= right;
      view.elevation = Math.min(Math.max(view.elevation + up, -90), 90);
      draw();
    };
    const grow = times => { view.size = Math.min(Math.max(view.size * times, 0.5), 20); draw(); };
    const reset = () => { Object.assign(view, home); draw(); };
    const hint = 'Drag to turn; keys: arrows, + and -, Escape; it shows the time chosen above';
    const bar = toolbar('View of the path', [
      ['\u21ba', 'Turn left', () => turn(-3 * TURN, 0)],
      ['\u21bb', 'Turn right', () => turn(3 * TURN, 0)],
      ['+', 'Enlarge', () => grow(KEY_ZOOM)], ['\u2212', 'Shrink', () => grow(1 / KEY_ZOOM)],
      ['Reset', 'Reset the view', reset]], hint);
    const grid = element('div', {class: 'grid', style: '--columns: 1fr 1fr'});
    live.append(bar, grid);
    const spaces = stages.map(stage => space(stage));
    const draw = () => spaces.forEach(one => one());
    link.follow.push(draw);
    redraws.push(draw);

    function space(stage) {
      const head = element('p', {class: 'head'});
      const canvas = element('canvas', {tabindex: 0, role: 'img', class: 'space', 'aria-label':
        `Flight path in space, ${stage}, velocity errors to ${Math.max(...data.errors[stage])}` +
        ' m/s; arrow keys turn it'});
      grid.append(element('div', {class: 'panel'}, head, canvas));
      let held = null;
      canvas.addEventListener('keydown', event => act({
        ArrowLeft: () => turn(-TURN, 0), ArrowRight: () => turn(TURN, 0),
        ArrowUp: () => turn(0, TURN), ArrowDown: () => turn(0, -TURN),
        '+': () => grow(KEY_ZOOM), '=': () => grow(KEY_ZOOM), '-': () => grow(1 / KEY_ZOOM),
        Escape: reset}[event.key], event));
      canvas.addEventListener('pointerdown', event => {
        held = event;
        canvas.setPointerCapture(event.pointerId);
        canvas.focus();
      });
      canvas.addEventListener('pointermove', event => {
        if (!held) return link.point(nearest(canvas, event), event);
        turn(DRAG * (event.clientX - held.clientX), DRAG * (event.clientY - held.clientY));
        held = event;
      });
      for (const end of ['pointerup', 'pointercancel']) {
        canvas.addEventListener(end, () => { held = null; });
      }
      canvas.addEventListener('pointerleave', event => link.point(null, event));
      const show = () => {
        const at = link.at, error = data.errors[stage];
        const place = at === null ? `; z ${sides[2].join(' to ')} m` :
          ` at ${data.t[at]} s, x, y, z ${where(at)} m`;
        head.replaceChildren(
          element('strong', {}, `velocity error ${stage}`), ...at === null
            ? ['0', element('span', {class: 'ramp', role: 'img', 'aria-label': 'to'}),
               `${most.toPrecision(2)} m/s${place}`]
            : [`${error[at]} m/s${place}`]);
        picture(canvas, data, sides, view, link, error, most);
      };
      new ResizeObserver(show).observe(canvas);
      return show;
    }

    function nearest(canvas, event) {
      const project = projection(canvas, sides, view);
      const far = data.path.map((place, k) => {
        const [x, y] = project(place), seen = k >= link.span[0] && k <= link.span[1];
        return seen ? Math.hypot(x - event.offsetX, y - event.offsetY) : Infinity;
      });
      const best = Math.min(...far);
      return best < NEAR ? far.indexOf(best) : null;
    }
  }

  // The marks of the ground below a path, in steps of 1, 2 or 5, and its heights [low, high].
  function box(path) {
    const ends = [0, 1, 2].map(axis => path.map(place => place[axis]))
      .map(values => [Math.min(...values), Math.max(...values)]);
    const extent = Math.max(...ends.map(([low, high]) => high - low)) || 1;
    const step = decades(extent / 9, extent).find(value => extent / value <= 5) ?? extent;
    return ends.map(([low, high], axis) => {
      if (axis === 2) return [low, high];
      const begin = Math.floor(low / step), end = Math.max(Math.ceil(high / step), begin + 1);
      return Array.from({length: end - begin + 1}, (_, k) => +((begin + k) * step).toPrecision(6));
    });
  }

  // Points (x, y, z) in m as places on a canvas in px and nearness, seen from infinitely far.
  function projection(canvas, sides, view) {
    const centre = sides.map(marks => (marks[0] + marks.at(-1)) / 2);
    const [long, wide, high] = sides.map(marks => marks.at(-1) - marks[0]);
    const across = Math.hypot(long, wide);
    const [turned, tilted] = [view.azimuth, view.elevation].map(angle => angle * Math.PI / 180);
    const tall = across * Math.abs(Math.sin(tilted)) + high * Math.cos(tilted);
    const scale = view.size * Math.min((canvas.clientWidth - MARGIN) / across,
                                       (canvas.clientHeight - MARGIN) / tall);
    return point => {
      const [x, y, z] = point.map((value, axis) => value - centre[axis]);
      const right = -x * Math.sin(turned) + y * Math.cos(turned);
      const near = x * Math.cos(turned) + y * Math.sin(turned);
      return [canvas.clientWidth / 2 + scale * right,
              canvas.clientHeight / 2 - scale * (z * Math.cos(tilted) - near * Math.sin(tilted)),
              near * Math.cos(tilted) + z * Math.sin(tilted)];
    };
  }

  function picture(canvas, data, sides, view, link, error, most) {
    const ratio = devicePixelRatio, pen = canvas.getContext('2d');
    canvas.width = ratio * canvas.clientWidth;
    canvas.height = ratio * canvas.clientHeight;
    pen.scale(ratio, ratio);
    const project = projection(canvas, sides, view);
    const stroke = (points, style, width) => {
      pen.beginPath();
      for (const [x, y] of points) pen.lineTo(x, y);
      Object.assign(pen, {strokeStyle: style, lineWidth: width, lineCap: 'round'}).stroke();
    };
    const [first, last] = link.span;
    const [small, large, shade] = ['measured', 'before', 'line'].map(colour);
    const points = data.path.map(project);
    const shadow = data.path.map(([x, y]) => project([x, y, sides[2][0]]));
    const order = points.map((_, k) => k).slice(first + 1, last + 1)
      .filter(k => !data.breaks.includes(k));
    ground(pen, sides, project, stroke);
    order.forEach(k => stroke([shadow[k - 1], shadow[k]], shade, 0.6));
    order.sort((one, other) => points[one][2] - points[other][2]);
    for (const k of order) {
      const part = 100 * error[k] / most;
      stroke([points[k - 1], points[k]], `color-mix(in srgb, ${large} ${part}%, ${small})`,
             1.5 + 0.045 * part);
    }
    if (link.at === null) return;
    pen.beginPath();
    pen.arc(points[link.at][0], points[link.at][1], 6, 0, 2 * Math.PI);
    Object.assign(pen, {strokeStyle: colour('ink'), lineWidth: 2}).stroke();
  }

  // A grid below the path with its marks in m.
  function ground(pen, [across, along, [bottom]], project, stroke) {
    Object.assign(pen, {fillStyle: colour('second'), font: '12px system-ui, sans-serif',
                        textAlign: 'center', textBaseline: 'middle'});
    const ruled = (name, marks, ends) => marks.forEach((mark, k) => {
      const [start, end] = ends(mark).map(project);
      stroke([start, end], colour('grid'), 1);
      const length = Math.hypot(end[0] - start[0], end[1] - start[1]) || 1;
      const away = [0, 1].map(axis => (end[axis] - start[axis]) / length);
      const text = k === marks.length - 1 ? `${name} ${mark} m` : mark;
      pen.fillText(text, end[0] + 20 * away[0], end[1] + 12 * away[1]);
    });
    ruled('x', across, x => [[x, along.at(-1), bottom], [x, along[0], bottom]]);
    ruled('y', along, y => [[across[0], y, bottom], [across.at(-1), y, bottom]]);
  }

  // ---- load ----

  for (const script of document.querySelectorAll('figure > script[type="application/json"]')) {
    const figure = script.parentElement, data = JSON.parse(script.textContent);
    const live = element('div', {class: 'live'});
    figure.insertBefore(live, script);
    figure.classList.add('moving');
    (data.panels ? charts : paths)(data, live);
  }
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () =>
    redraws.forEach(redraw => redraw()));
})();
