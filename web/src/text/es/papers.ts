import type * as en from '../papers';
import type { Translation } from './translation';

export const card: Translation<typeof en.card> = {
  title: 'Tablilla de desvíos',
  lead: 'Lo que el modelo prevé a cada rumbo, con su banda del 95 %, en una hoja para imprimir. Lleva la marca de prevista hasta que los rumbos en la mar verifican la compensación de la que procede. No es un certificado: el lugar de la firma queda en blanco.',
  make: 'Hacer la tablilla',
  making: 'Haciendo…',
  again: 'Hacerla de nuevo',
  moved: 'Para el lugar y el día elegidos arriba.',
  of: (place, day) => `Para ${place}, ${day}.`,
  model: (version, band) => `Según el modelo ${version}, a ${band} o mejor.`,
  predicted: 'Prevista',
  verified: 'Verificada en la mar',
  byModel: 'solo por el modelo.',
  foretold:
    'cuando la aguja se compensó en el atraque; los rumbos en la mar todavía no la han verificado.',
  byOrder: (headings, until, adjusted) =>
    `por ${headings} rumbos hasta ${until}, después de la compensación del ${adjusted}.`,
  order: 'Orden de trabajo',
  alt: 'La tablilla de desvíos tal como se imprime; lo mismo como texto está en la tabla de desvíos.',
  forms: {
    pdf: 'Imprimir (PDF)',
    svg: 'Imagen (SVG)',
    csv: 'Tabla (CSV)',
    json: 'Datos (JSON)',
  },
  refused: 'Ahora no se puede hacer ninguna tablilla:',
  cure: 'Vuelve a haberla cuando termina la alerta.',
  toAlert: 'La alerta',
  notRecorded: 'No consta aquí; lo escribe una persona:',
  unrecorded: {
    correctors: 'cómo están los correctores',
    degaussing_coils: 'el reglaje de las bobinas de desmagnetización',
    adjuster: 'compensador, licencia y empresa',
    signature: 'la firma de un compensador',
    next_due: 'cuándo vence la próxima compensación',
  },
};

export const book: Translation<typeof en.book> = {
  title: 'Libro de desvíos',
  lead: 'Correcciones totales observadas navegando: una en cada guardia de cuatro horas y una tras cada cambio de rumbo de 20° o más, junto a lo que decía la tablilla de entonces.',
  from: 'Primer día',
  to: 'Último día',
  whole: 'Sin días, el libro entero.',
  wrongOrder: 'El último día es anterior al primero.',
  pdf: 'Imprimir (PDF)',
  csv: 'Tabla (CSV)',
};
