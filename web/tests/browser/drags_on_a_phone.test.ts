import { describeDrags } from './drags';

describeDrags('a phone of 390 px', true);
