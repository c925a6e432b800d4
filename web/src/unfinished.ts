/**
 * Fields in which something stands that is no value yet, such as a day without its hour. A
 * browser gives such a field as an empty one: what was typed would be left out unsaid.
 */

import * as text from './text';

const isUnfinished = (field: Element): field is HTMLInputElement =>
  field instanceof HTMLInputElement && field.validity.badInput;

/** Keeps a form that has one from being sent, and says so at the field. */
export function holdUnfinished(event: SubmitEvent): void {
  if (!(event.target instanceof HTMLFormElement)) return;
  const field = [...event.target.elements].find(isUnfinished);
  if (!field) return;
  event.preventDefault();
  event.stopImmediatePropagation();
  field.setCustomValidity(text.unfinished);
  field.reportValidity();
  field.addEventListener(
    'blur',
    () => {
      field.setCustomValidity('');
    },
    { once: true },
  );
}
