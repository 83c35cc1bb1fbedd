/* Copyright 2026 quad_ident_ros contributors
   SPDX-License-Identifier: Apache-2.0 */

// Lets a reader filter the vehicles and effects of a fleet's page, and sort its tables.
'use strict';
(() => {
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const element = (name, attributes = {}, ...content) => {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...content);
    return made;
  };

  // ---- sort ----

  const {compare: inOrder} = new Intl.Collator('en', {numeric: true});    // uav9 before uav10

  // The number of a cell of numbers, else its text.
  function value(cell) {
    const text = cell.textContent.trim();
    const number = cell.matches('th, .text, .prose') ? NaN
      : parseFloat(cell.dataset.value ?? text);
    return Number.isNaN(number) ? text : number;
  }

  // Cells without a value come last, whichever way the others go.
  function compare(one, other, sign) {
    if (one === '' || other === '') return Number(one === '') - Number(other === '');
    return sign * (typeof one === 'number' && typeof other === 'number' ? one - other
      : inOrder(one, other));
  }

  for (const table of all('.sortable table')) {
    const heads = all('thead th', table), body = table.tBodies[0];
    for (const head of heads) {
      const button = element('button', {type: 'button'}, ...head.childNodes);
      head.replaceChildren(button);
      button.addEventListener('click', () => {
        const rising = head.getAttribute('aria-sort') !== 'ascending';
        heads.forEach(one => one.removeAttribute('aria-sort'));
        head.setAttribute('aria-sort', rising ? 'ascending' : 'descending');
        const place = head.cellIndex, sign = rising ? 1 : -1;
        body.append(...[...body.rows].sort(
          (one, other) => compare(value(one.cells[place]), value(other.cells[place]), sign)));
      });
    }
  }

  // ---- filter ----

  const figures = all('.multiples figure');
  const items = all('.first > li').map(row => ({row, name: row.dataset.vehicle.toLowerCase()}));
  // Rows of tables with a column of vehicles: {row, the vehicle's name}.
  const rows = [...items, ...all('.sortable table').flatMap(table => {
    const place = all('thead tr:first-child > *', table).findIndex(
      head => head.textContent.trim() === 'vehicle');
    return place < 0 ? [] : [...table.tBodies[0].rows].map(
      row => ({row, name: row.cells[place].textContent.trim().toLowerCase()}));
  })];
  const first = document.querySelector('h2');
  if (!first || !rows.length) return;

  const text = element('input', {type: 'search', autocomplete: 'off'});
  const effect = element('select', {}, element('option', {value: ''}, 'all'));
  const titles = new Map(figures.map(one => [one.dataset.effect, one.dataset.title]));
  for (const [name, title] of [...titles].sort()) {
    effect.append(element('option', {value: name}, title));
  }
  const happened = element('input', {type: 'checkbox'});
  const told = element('span', {class: 'second', role: 'status'});
  const bar = element('div', {class: 'tools filter', role: 'search', 'aria-label': 'Filter'},
    element('label', {}, 'Vehicle', text), element('label', {}, 'Effect', effect),
    element('label', {}, happened, 'only changes and drifts'), told);
  first.before(bar);

  function apply() {
    const wanted = text.value.trim().toLowerCase().split(/[\s,]+/).filter(Boolean);
    const fits = name => !wanted.length || name === 'all' || wanted.some(one => name.includes(one));
    for (const {row, name} of rows) row.hidden = !fits(name);
    let count = 0;
    for (const one of figures) {
      one.hidden = !(fits(one.dataset.vehicle.toLowerCase())
        && (!effect.value || one.dataset.effect === effect.value)
        && (!happened.checked || one.dataset.event === '1'));
      count += !one.hidden;
    }
    told.textContent = `${count} of ${figures.length} pictures`;
  }

  for (const one of [text, effect, happened]) one.addEventListener('input', apply);
  apply();
})();
