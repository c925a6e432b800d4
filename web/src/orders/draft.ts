/** What is being typed, kept in the browser so that a reload or a closed tab loses nothing. */

/** Keeps a draft of an order's form. */
export function keepDraft(order: string, form: string, draft: unknown): void {
  try {
    localStorage.setItem(name(order, form), JSON.stringify(draft));
  } catch {
    // A full or forbidden store keeps no draft; the form itself still holds it.
  }
}

/** The draft that was kept, laid over `fresh` so that no field is missing. */
export function keptDraft<T extends object>(order: string, form: string, fresh: T): T {
  try {
    const kept: unknown = JSON.parse(localStorage.getItem(name(order, form)) ?? 'null');
    return typeof kept === 'object' && kept !== null ? { ...fresh, ...kept } : fresh;
  } catch {
    return fresh;
  }
}

export function forgetDraft(order: string, form: string): void {
  try {
    localStorage.removeItem(name(order, form));
  } catch {
    // Nothing was kept.
  }
}

const name = (order: string, form: string): string => `binnacle.draft.${order}.${form}`;
