import type * as en from '../finder';
import type { Translation } from './translation';

export const finder: Translation<typeof en.finder> = {
  title: 'Buscar',
  open: 'Buscar…',
  keys: 'Ctrl K',
  label: 'Buque, puerto, orden de trabajo, página o ajuste',
  results: 'Encontrado',
  none: (query) => `Nada se llama «${query}».`,
  count: (n) => (n === 1 ? '1 resultado' : `${n} resultados`),
  loading: 'Consultando buques y órdenes…',
  failed: 'No se pudieron cargar buques y órdenes: solo se encuentran páginas.',
  help: 'Las flechas eligen, Intro abre, Esc cierra.',
  close: 'Cerrar',
  kinds: {
    vessel: 'Buque',
    port: 'Puerto',
    order: 'Orden de trabajo',
    page: 'Página',
    setting: 'Ajuste',
  },
  settings: [
    'Contraseña',
    'Segundo factor',
    'Tokens de la API',
    'Horas: UTC u hora del buque',
    'Idioma · Language',
  ],
  order: (vessel) => `Compensación de ${vessel}`,
  call: (vessel, on) => `${vessel} llega ${on}`,
};
