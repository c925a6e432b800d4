import type * as en from '../help';
import type { Translation } from './translation';

export const help: Translation<typeof en.help> = {
  title: 'Ayuda',
  lead: 'Para qué sirve cada página y cómo se obtienen sus cifras. Los temas están en inglés.',
  search: 'Buscar en la ayuda',
  searchHint: 'En inglés, por ejemplo: deviation card, webhook, storm',
  topics: 'Temas',
  found: (n) => (n === 1 ? '1 pasaje' : `${n} pasajes`),
  none: (query) => `En la ayuda no aparece «${query}».`,
  unknown: 'No existe ese tema. Elegir uno de la lista.',
  tryApi: 'Probar la API en el navegador',
  tryApiLead: 'Cada operación con sus campos y un ejemplo, para probarla con la propia cuenta.',
  all: 'Todos los temas',
  about: (what) => `Ayuda: ${what}`,
};
