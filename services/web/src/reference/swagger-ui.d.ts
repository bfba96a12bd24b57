/** What this page uses of Swagger UI, which has no types of its own. */
declare module "swagger-ui-dist/swagger-ui-es-bundle.js" {
  interface Options {
    dom_id: string;
    url: string;
    deepLinking: boolean;
    defaultModelRendering: "example" | "model";
    docExpansion: "list" | "full" | "none";
    validatorUrl: null;
  }
  export default function SwaggerUI(options: Options): unknown;
}
