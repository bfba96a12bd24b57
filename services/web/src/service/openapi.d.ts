/** Made by generate-types.mjs. */
export interface paths {
    "/v1/renders": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Renders
         * @description One page of renders, newest first.
         */
        get: operations["list_renders"];
        put?: never;
        /**
         * Create Render
         * @description Submits a scene. Repeating a request_id gives back the render made before.
         */
        post: operations["create_render"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Render
         * @description One render, by its id or the beginning of it.
         */
        get: operations["get_render"];
        put?: never;
        post?: never;
        /**
         * Delete Render
         * @description Forgets a render that has ended, with its images and the files that no other render uses.
         */
        delete: operations["delete_render"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}:replay": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Replay Render
         * @description A new render with the samples per tile that this one has now: its image has the same bits.
         */
        post: operations["replay_render"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}/explanation": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Explain Render
         * @description What the render waits for, in one sentence.
         */
        get: operations["explain_render"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}/tiles-in-progress": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Tiles In Progress
         * @description Which tiles are being traced, and by whom.
         */
        get: operations["get_tiles_in_progress"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}/convergence": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Convergence
         * @description The error estimate at every preview so far.
         */
        get: operations["get_convergence"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}:cancel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cancel Render
         * @description Stops a render; what was merged stays and can be fetched. Changes nothing on an ended render.
         */
        post: operations["cancel_render"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}:pause": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Pause Render
         * @description No more work until it is resumed; what is merged stays.
         */
        post: operations["pause_render"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}:resume": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Resume Render
         * @description Goes on with a paused render; with a degraded one, by tracing its failed tiles again.
         */
        post: operations["resume_render"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}:extend": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Extend Render
         * @description More samples or other conditions, also after the end; nothing is traced again.
         */
        post: operations["extend_render"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}:setPriority": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Set Priority
         * @description The render's weight among those of its owner.
         */
        post: operations["set_priority"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}:lookFirst": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Look First
         * @description Which part of the film gets its samples first; the finished image has the same bits with or without.
         */
        post: operations["look_first"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/preflights": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Preflight
         * @description What each part of a scene changes and costs, and the document that is enough. Takes minutes.
         */
        post: operations["preflight"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}/preview.png": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Preview
         * @description The tone-mapped PNG of what is merged now.
         */
        get: operations["get_preview"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}/thumbnail.png": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Thumbnail
         * @description The preview in small, for lists.
         */
        get: operations["get_thumbnail"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}/tiles": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Tiles
         * @description Tiles whose samples changed since an earlier answer, as floats; about 4 MiB at once.
         *
         *     The layout is in docs/reference/api.md. 304 where If-None-Match is `since` and nothing changed.
         */
        get: operations["get_tiles"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}/image.exr": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Image
         * @description EXR: X, Y, Z, Y.stderr, n; of what is merged now until the render has ended, then final.
         */
        get: operations["get_image"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/renders/{render_id}/events": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Render Events
         * @description The render now and after every change; the stream ends after the final state.
         *
         *     With Last-Event-ID only states after it are sent. If that was the final one the answer is 204, which tells
         *     a browser to stop asking.
         */
        get: operations["render_events"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/events": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * All Events
         * @description The newest 200 renders, then each of them after every change.
         *
         *     With `render`, at most four times, only those, also after their ends; each change is followed by an event
         *     `tiles` that names the tiles with new samples, where there are any.
         */
        get: operations["all_events"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/session": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Session
         * @description Who the caller is, and what it may do; without authentication nobody, and everything.
         */
        get: operations["get_session"];
        put?: never;
        /**
         * Begin Session
         * @description Takes the token of the Authorization header into a cookie that scripts cannot read.
         */
        post: operations["begin_session"];
        /**
         * End Session
         * @description Takes the cookie back.
         */
        delete: operations["end_session"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/assets:batchMissing": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Missing Assets
         * @description Which of these files the service does not have yet.
         */
        post: operations["missing_assets"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/assets/{sha256}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Store Asset
         * @description Stores a file; its bytes must have this digest and the declared length. Uploading again is harmless.
         */
        put: operations["store_asset"];
        post?: never;
        delete?: never;
        options?: never;
        /**
         * Asset Size
         * @description Whether a file is stored; Content-Length is its size.
         */
        head: operations["asset_size"];
        patch?: never;
        trace?: never;
    };
    "/v1/workers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Workers
         * @description The workers heard of in the last ten seconds.
         */
        get: operations["list_workers"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/workers/history": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Worker History
         * @description Worker events (joined, left, quarantined, released) and the rate of all workers, by the minute.
         */
        get: operations["get_worker_history"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/workers/{worker_id}:release": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Release Worker
         * @description Takes the results of a worker in quarantine again.
         */
        post: operations["release_worker"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/webhooks": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Webhooks
         * @description The caller's; everybody's for admins.
         */
        get: operations["list_webhooks"];
        put?: never;
        /**
         * Create Webhook
         * @description Tells an address how the caller's renders end, in signed messages (standardwebhooks.com).
         */
        post: operations["create_webhook"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/v1/webhooks/{webhook_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Delete Webhook
         * @description Tells it nothing more.
         */
        delete: operations["delete_webhook"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/healthz": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Alive
         * @description The process answers.
         */
        get: operations["alive"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/readyz": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Ready
         * @description The data folder answers too; else 503.
         */
        get: operations["ready"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/metrics": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Metrics
         * @description Counts and states in the text format of Prometheus.
         */
        get: operations["metrics"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
}
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        /**
         * @description A stored file.
         * @example {
         *       "sha256": "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae",
         *       "size_bytes": 3
         *     }
         */
        Asset: {
            /** @description Lower-case hexadecimal. */
            sha256: string;
            size_bytes: number;
        };
        /**
         * @description The files that a caller is about to upload.
         * @example {
         *       "sha256": [
         *         "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae"
         *       ]
         *     }
         */
        BatchMissingRequest: {
            /** @description SHA-256 digests, lower-case hexadecimal. */
            sha256: string[];
        };
        /**
         * @description Those of the files that the service does not have, in the order asked.
         * @example {
         *       "sha256": [
         *         "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae"
         *       ]
         *     }
         */
        BatchMissingResponse: {
            sha256: string[];
        };
        /** @description The error estimate over time, oldest first. */
        Convergence: {
            points: components["schemas"]["ConvergencePoint"][];
        };
        /** @description The error estimate at one preview. */
        ConvergencePoint: {
            /** @description Seconds since the start of the render. */
            time_s: number;
            /** @description Mean samples per pixel. */
            samples: number;
            /** @description As in Progress. */
            relative_error: number;
            /** @description As in Progress. */
            worst_share: number;
            /** @description As in Progress. */
            effective_pixels: number;
        };
        /**
         * @description A scene to render.
         * @example {
         *       "height": 480,
         *       "name": "lamp",
         *       "priority": 100,
         *       "request_id": "night-1",
         *       "samples": 1024,
         *       "scene": {
         *         "nocturne": 1,
         *         "sensor": {
         *           "look_at": [
         *             0,
         *             0,
         *             0
         *           ],
         *           "position": [
         *             0,
         *             0,
         *             4
         *           ],
         *           "type": "pinhole",
         *           "up": [
         *             0,
         *             1,
         *             0
         *           ],
         *           "vertical_field_of_view_degrees": 40
         *         },
         *         "surfaces": [
         *           {
         *             "kernel": {
         *               "reflectance": 0.5,
         *               "type": "lambertian"
         *             },
         *             "luminaire": {
         *               "radiance": {
         *                 "blackbody": 3000
         *               }
         *             },
         *             "name": "lamp",
         *             "shape": {
         *               "corner": [
         *                 0,
         *                 0,
         *                 0
         *               ],
         *               "edge_u": [
         *                 1,
         *                 0,
         *                 0
         *               ],
         *               "edge_v": [
         *                 0,
         *                 1,
         *                 0
         *               ],
         *               "type": "quad"
         *             }
         *           }
         *         ]
         *       },
         *       "stop": {
         *         "relative_error": 0.01,
         *         "until": "07:00 Europe/Berlin"
         *       },
         *       "width": 640
         *     }
         */
        CreateRenderRequest: {
            /** @description Chosen by the caller, 1 to 128 printable characters: the same id gives the same render again. */
            request_id: string;
            /**
             * @description At most 200 printable characters.
             * @default
             */
            name?: string;
            scene: components["schemas"]["SceneDocument"];
            /** @description Pixels. */
            width: number;
            /** @description Pixels. */
            height: number;
            /** @description Samples per pixel, at most. */
            samples: number;
            stop?: components["schemas"]["StopRequest"];
            /**
             * @description 1 to 1000; 0 means 100.
             * @default 0
             */
            priority?: number;
        };
        /**
         * @description An address to tell.
         * @example {
         *       "url": "https://example.org/nocturne"
         *     }
         */
        CreateWebhookRequest: {
            /** @description https, and a public address. */
            url: string;
        };
        /**
         * @description What a render waits for.
         * @example {
         *       "sentence": "It is running on 16 worker threads, shared with 0 other renders."
         *     }
         */
        Explanation: {
            sentence: string;
        };
        /**
         * @description More samples, or other conditions.
         * @example {
         *       "samples": 4096
         *     }
         */
        ExtendRenderRequest: {
            /** @default  */
            request_id?: string;
            /**
             * @description In all, at least as many as before; 0 means as many.
             * @default 0
             */
            samples?: number;
            /** @description Instead of those before. */
            stop?: components["schemas"]["StopRequest"];
        };
        /** @description An estimate, and the interval that holds the truth with 95 %. */
        Interval: {
            value: number;
            low: number;
            high: number;
        };
        /**
         * @description A part of the film, in pixels from its upper left corner; width and height 0: all parts are alike.
         * @example {
         *       "height": 128,
         *       "width": 128,
         *       "x": 64,
         *       "y": 32
         *     }
         */
        LookFirstRequest: {
            /** @default  */
            request_id?: string;
            /** @default 0 */
            x?: number;
            /** @default 0 */
            y?: number;
            /** @default 0 */
            width?: number;
            /** @default 0 */
            height?: number;
        };
        /**
         * @description A webhook with the secret, which is told once.
         * @example {
         *       "created": 1795305600,
         *       "id": "wh-5k2q",
         *       "last_outcome": "",
         *       "owner": "studio",
         *       "secret": "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw",
         *       "url": "https://example.org/nocturne"
         *     }
         */
        NewWebhook: {
            id: string;
            /** @description Name of the token that made it; empty without authentication. */
            owner: string;
            url: string;
            /** @description Unix time, seconds. */
            created: number;
            /** @description How the last message went, in words; empty before the first. */
            last_outcome: string;
            /** @description What messages are signed with, by standardwebhooks.com. */
            secret: string;
        };
        /** @description The small renders that the report goes by. */
        Pilot: {
            /** @description Width and height, pixels. */
            film: number[];
            /** @description Per pixel of each render. */
            samples: number;
            /** @description Independent renders of each model. */
            renders: number;
            /** @description What they took. */
            cpu_seconds: number;
            /** @description A budget that would show biases of half of the target; null: this one does. */
            wanted_cpu_seconds: number | null;
            /** @description As in Progress. */
            effective_pixels: number;
            /** @description Rare samples carry the noise: intervals and times are not to be trusted. */
            heavy_tails: boolean;
        };
        /** @description The scene with some parts less. Errors are relative. */
        PreflightModel: {
            /** @description What is left out; empty: nothing. */
            without: string[];
            verdict: string;
            /** @description Of the mean luminance. */
            mean_bias: components["schemas"]["Interval"];
            /** @description Relative RMSE over pixels of the change. */
            local_bias: components["schemas"]["Interval"];
            /** @description Relative RMSE over pixels of one sample per pixel. */
            noise_of_a_sample: number;
            /** @description Time of a sample, relative to the full model. */
            cost_ratio: components["schemas"]["Interval"];
            /** @description Per pixel, to the target; null: out of reach. */
            samples: number | null;
            /** @description Of one processor, to the target; null: out of reach. */
            cpu_seconds: number | null;
        };
        /** @description What a scene needs for an error. */
        PreflightReport: {
            /** @description The target. */
            error: number;
            /** @description Width and height of the real render, pixels. */
            film: number[];
            pilot: components["schemas"]["Pilot"];
            full: components["schemas"]["PreflightModel"];
            /** @description Each with one part less. */
            models: components["schemas"]["PreflightModel"][];
            /** @description The cheapest that stays within the target. */
            chosen: components["schemas"]["PreflightModel"];
            /** @description How many times faster than the full model it gets there. */
            saving: number;
            /** @description Parts that change nothing of what is traced. */
            without_effect: string[];
            /** @description The scene document of the chosen model. */
            document: components["schemas"]["SceneDocument"];
        };
        /**
         * @description A scene, and the error that is wanted of its image.
         * @example {
         *       "budget_seconds": 60,
         *       "error": 0.02,
         *       "height": 480,
         *       "scene": {
         *         "nocturne": 1,
         *         "sensor": {
         *           "look_at": [
         *             0,
         *             0,
         *             0
         *           ],
         *           "position": [
         *             0,
         *             0,
         *             4
         *           ],
         *           "type": "pinhole",
         *           "up": [
         *             0,
         *             1,
         *             0
         *           ],
         *           "vertical_field_of_view_degrees": 40
         *         },
         *         "surfaces": [
         *           {
         *             "kernel": {
         *               "reflectance": 0.5,
         *               "type": "lambertian"
         *             },
         *             "luminaire": {
         *               "radiance": {
         *                 "blackbody": 3000
         *               }
         *             },
         *             "name": "lamp",
         *             "shape": {
         *               "corner": [
         *                 0,
         *                 0,
         *                 0
         *               ],
         *               "edge_u": [
         *                 1,
         *                 0,
         *                 0
         *               ],
         *               "edge_v": [
         *                 0,
         *                 1,
         *                 0
         *               ],
         *               "type": "quad"
         *             }
         *           }
         *         ]
         *       },
         *       "width": 640
         *     }
         */
        PreflightRequest: {
            /** @description Files that it names are uploaded before. */
            scene: components["schemas"]["SceneDocument"];
            /**
             * @description Film of the real render, pixels.
             * @default 512
             */
            width?: number;
            /**
             * @description Film of the real render, pixels.
             * @default 512
             */
            height?: number;
            /**
             * @description Total relative error, bias and noise together, in (0, 1).
             * @default 0.02
             */
            error?: number;
            /**
             * @description Processor time of the small renders, about; at most 120.
             * @default 60
             */
            budget_seconds?: number;
        };
        /** @description One thing wrong with a request. */
        Problem: {
            /** @description Where: `$.scene.surfaces[3].kernel` in the body, `query.page_size`, ... */
            place: string;
            message: string;
        };
        /**
         * @description RFC 9457 problem details.
         * @example {
         *       "detail": "$.width: is 0 pixels; expected 1 to 16384",
         *       "problems": [
         *         {
         *           "message": "is 0 pixels; expected 1 to 16384",
         *           "place": "$.width"
         *         }
         *       ],
         *       "reason": "INVALID_INPUT",
         *       "status": 422,
         *       "title": "The request is not valid",
         *       "type": "about:blank"
         *     }
         */
        ProblemDetails: {
            /** @default about:blank */
            type: string;
            title: string;
            /** @description The HTTP status. */
            status: number;
            /** @description What was wrong, in words. */
            detail: string;
            /** @description The same in one word for programs; see the table of errors. */
            reason: string;
            /**
             * @description At most 20, with their places.
             * @default []
             */
            problems: components["schemas"]["Problem"][];
        };
        /** @description What has been merged and committed of a render. */
        Progress: {
            /** @description Sample ranges merged. */
            ranges_done: number;
            /** @description Sample ranges of the whole render. */
            ranges_planned: number;
            /** @description Samples merged, of all pixels together. */
            samples_merged: number;
            /** @description Rays cast for them. */
            rays: number;
            /** @description Contributions left out because they were NaN, infinite or negative. */
            invalid_samples: number;
            /** @description Mean over pixels of the samples merged. */
            mean_samples: number;
            /** @description Root mean square over pixels of Y's standard error relative to Y, sqrt(mean(var / (Y^2 + 0.01 M^2))) with M the image's mean Y; 0: unknown. */
            relative_error: number;
            /** @description Part of the square of relative_error that the worst 1 % of the pixels have; 0: unknown. */
            worst_share: number;
            /** @description Effective sample size (Kish) of the pixels that carry the error, (sum v)^2 / sum v^2 of their relative variances; 0: unknown. */
            effective_pixels: number;
            /** @description Rate of the last minutes; 0 when nothing comes back. */
            samples_per_second: number;
            /** @description The same in rays. */
            rays_per_second: number;
            /** @description Processor seconds spent by workers. */
            cpu_seconds: number;
            /** @description Tiles that need no more samples. */
            tiles_done: number;
            /** @description Tiles of the film. */
            tiles: number;
            /** @description Tiles that were given up after failing on several workers. */
            tiles_failed: number;
            /** @description Ranges that another worker traced again with the same result. */
            audited: number;
            /** @description Results that were refused because they could not be right. */
            refused: number;
            /** @description Unix time at which the render should end, from its rate and error so far; 0: unknown. */
            predicted_end: number;
            /** @description Processor seconds that it should have cost by then; 0: unknown. */
            predicted_cpu_seconds: number;
        };
        /** @description What all workers together did at one time. */
        RatePoint: {
            unix_time: number;
            threads: number;
            /** @description Samples times the wavelengths of each, a second. */
            photons_per_second: number;
        };
        /** @description Pixels [x, x + width) times [y, y + height), from the upper left corner. */
        Region: {
            x: number;
            y: number;
            width: number;
            height: number;
        };
        /**
         * @description One render.
         * @example {
         *       "created": 1795305600,
         *       "ended": 0,
         *       "floating_point_profile": "x86-64-avx2",
         *       "height": 480,
         *       "id": "r-mfzwkzdvnq2a",
         *       "look_first": {
         *         "height": 128,
         *         "width": 128,
         *         "x": 64,
         *         "y": 32
         *       },
         *       "name": "lamp",
         *       "owner": "studio",
         *       "priority": 100,
         *       "progress": {
         *         "audited": 12,
         *         "cpu_seconds": 500,
         *         "effective_pixels": 180000,
         *         "invalid_samples": 0,
         *         "mean_samples": 256,
         *         "predicted_cpu_seconds": 2000,
         *         "predicted_end": 1795305900,
         *         "ranges_done": 1200,
         *         "ranges_planned": 3600,
         *         "rays": 314572800,
         *         "rays_per_second": 5000000,
         *         "refused": 0,
         *         "relative_error": 0.021,
         *         "samples_merged": 78643200,
         *         "samples_per_second": 1250000,
         *         "tiles": 300,
         *         "tiles_done": 0,
         *         "tiles_failed": 0,
         *         "worst_share": 0.04
         *       },
         *       "reason": "",
         *       "samples": 1024,
         *       "scene_sha256": "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae",
         *       "sequence": 12,
         *       "started": 1795305601.5,
         *       "state": "RUNNING",
         *       "stop": {
         *         "cpu_seconds": 0,
         *         "relative_error": 0.01,
         *         "tile_relative_error": 0,
         *         "until": "07:00 Europe/Berlin",
         *         "until_time": 1795327200,
         *         "wall_seconds": 0
         *       },
         *       "width": 640
         *     }
         */
        Render: {
            id: string;
            name: string;
            state: components["schemas"]["RenderState"];
            /** @description Why it is in this state, in words; may be empty. */
            reason: string;
            /** @description Pixels. */
            width: number;
            /** @description Pixels. */
            height: number;
            /** @description Samples per pixel asked for, at most. */
            samples: number;
            /** @description SHA-256 of the compiled scene, hexadecimal. */
            scene_sha256: string;
            /** @description How its workers round, which all do alike; empty before the first result. */
            floating_point_profile: string;
            /** @description Grows with every change that watchers should see. */
            sequence: number;
            /** @description Unix time, seconds. */
            created: number;
            /** @description Unix time, seconds; 0 before the start. */
            started: number;
            /** @description Unix time, seconds; 0 before the end. */
            ended: number;
            stop: components["schemas"]["StopConditions"];
            /** @description 1 to 1000: the render's weight among those of its owner. */
            priority: number;
            /** @description Name of the token that asked for it; empty without authentication. */
            owner: string;
            /** @description The part of the film that gets its samples first; null: all parts are alike. */
            look_first: components["schemas"]["Region"] | null;
            progress: components["schemas"]["Progress"];
        };
        /** @description Doing it twice is doing it once; the request id is kept for the log only. */
        RenderActionRequest: {
            /** @default  */
            request_id?: string;
        };
        /** @description One page of renders, newest first. */
        RenderPage: {
            renders: components["schemas"]["Render"][];
            /** @description Empty on the last page. */
            next_page_token: string;
        };
        /**
         * @description Where a render stands; from SUCCEEDED on it has ended, though it may be extended.
         * @enum {string}
         */
        RenderState: "QUEUED" | "RUNNING" | "PAUSED" | "SUCCEEDED" | "STOPPED_EARLY" | "DEGRADED" | "FAILED" | "CANCELLED";
        /**
         * @description A new render with the samples per tile that this one has now.
         * @example {
         *       "request_id": "night-1-again"
         *     }
         */
        ReplayRenderRequest: {
            /** @description Chosen by the caller, 1 to 128 printable characters: the same id gives the same render again. */
            request_id: string;
        };
        /**
         * SceneDocument
         * @description A whole scene.
         */
        SceneDocument: {
            /**
             * Nocturne
             * @description Version of this format.
             * @constant
             */
            nocturne: 1;
            /**
             * Name
             * @description For people; not part of the compiled scene.
             * @default
             */
            name?: string;
            /**
             * Source
             * @description Where the scene's data come from.
             * @default
             */
            source?: string;
            /**
             * Note
             * @description Anything worth knowing about the scene.
             * @default
             */
            note?: string;
            /**
             * Spectra
             * @description Spectra by name. Only those that are used are compiled.
             * @default {}
             */
            spectra?: {
                [key: string]: number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            };
            /**
             * Textures
             * @description Textures by name. Only those that are used are compiled.
             * @default {}
             */
            textures?: {
                [key: string]: components["schemas"]["Scene.Texture"];
            };
            /**
             * Kernels
             * @description Kernels by name. Only those that are used are compiled.
             * @default {}
             */
            kernels?: {
                [key: string]: components["schemas"]["Scene.Lambertian"] | components["schemas"]["Scene.DiffuseTransmitter"] | components["schemas"]["Scene.Conductor"] | components["schemas"]["Scene.Dielectric"] | components["schemas"]["Scene.ThinPane"] | components["schemas"]["Scene.CoatedDiffuse"] | components["schemas"]["Scene.Phong"] | components["schemas"]["Scene.Measured"] | components["schemas"]["Scene.Blend"] | components["schemas"]["Scene.Mask"] | components["schemas"]["Scene.TwoSided"] | components["schemas"]["Scene.Passage"];
            };
            /**
             * Media
             * @description Media by name: fog, smoke, milk. Only those that are used are compiled.
             * @default {}
             */
            media?: {
                [key: string]: components["schemas"]["Scene.Medium"];
            };
            /**
             * Groups
             * @description Surfaces that only instances show, and instances of other groups, by name.
             * @default {}
             */
            groups?: {
                [key: string]: (components["schemas"]["Scene.Surface"] | components["schemas"]["Scene.Instance"])[];
            };
            /**
             * Sensor
             * @description The camera or meter.
             */
            sensor: components["schemas"]["Scene.Pinhole"] | components["schemas"]["Scene.ThinLens"] | components["schemas"]["Scene.Orthographic"] | components["schemas"]["Scene.Panorama"] | components["schemas"]["Scene.IrradianceMeter"] | components["schemas"]["Scene.RadianceMeter"] | components["schemas"]["Scene.IntensityMeter"];
            /**
             * Surfaces
             * @description What light can meet; at least one surface or instance.
             * @default []
             */
            surfaces?: components["schemas"]["Scene.Surface"][];
            /**
             * Instances
             * @description Groups, where they stand.
             * @default []
             */
            instances?: components["schemas"]["Scene.Instance"][];
            /**
             * Unbounded Media
             * @description Names from `$.media` that fill all of space, except for dielectric bodies.
             * @default []
             */
            unbounded_media?: string[];
            /**
             * @description A planet with its air.
             * @default null
             */
            atmosphere?: components["schemas"]["Scene.Atmosphere"] | null;
            /**
             * Environment
             * @description Light from infinitely far away, from all directions.
             * @default null
             */
            environment?: (components["schemas"]["Scene.ConstantEnvironment"] | components["schemas"]["Scene.EnvironmentMap"]) | null;
            /**
             * Distant
             * @description Discs at infinity, such as the Sun.
             * @default []
             */
            distant?: components["schemas"]["Scene.DistantDisc"][];
            /**
             * Important Directions
             * @description Shapes that are worth looking at from everywhere.
             * @default []
             */
            important_directions?: components["schemas"]["Scene.ImportantDirection"][];
            /**
             * @description How photons are traced.
             * @default {
             *       "h": null,
             *       "roulette": "weight",
             *       "roulette_after": 2,
             *       "maximum_depth": null,
             *       "estimator": "two_photons",
             *       "split_vertices": 1,
             *       "mixture": {
             *         "environment": null,
             *         "important": null,
             *         "kernel": 0.65,
             *         "luminaires": null,
             *         "uniform": 0
             *       },
             *       "photons_together": "auto",
             *       "direction": "adjoint",
             *       "aimed_emission": 0,
             *       "sequence": "sobol",
             *       "seed": 0
             *     }
             */
            tracing?: components["schemas"]["Scene.Tracing"];
        };
        /**
         * @description Who the caller is.
         * @example {
         *       "name": "studio",
         *       "scopes": [
         *         "read",
         *         "submit"
         *       ]
         *     }
         */
        Session: {
            /** @description Of the token; empty without authentication. */
            name: string;
            /** @description Of read, submit, worker and admin. */
            scopes: string[];
        };
        /**
         * @description The render's weight among those of its owner.
         * @example {
         *       "priority": 200
         *     }
         */
        SetPriorityRequest: {
            /** @default  */
            request_id?: string;
            /** @description 1 to 1000; 200 gets twice the work of 100. */
            priority: number;
        };
        /** @description When a render ends besides at its last sample: at the first that is met. 0 or empty: not asked for. */
        StopConditions: {
            /** @description Of the image, as in Progress. */
            relative_error: number;
            /** @description Of each tile, from its own pixels; a tile that has it gets no more samples. */
            tile_relative_error: number;
            /** @description Seconds of running, without pauses. */
            wall_seconds: number;
            /** @description Processor seconds of workers. */
            cpu_seconds: number;
            /** @description A time with its zone, as it was given. */
            until: string;
            /** @description The same as Unix time. */
            until_time: number;
        };
        /**
         * @description When a render should end besides at its last sample, whichever comes first; 0 or empty: not asked for.
         *
         *     The schema of `stop` in requests. The coordinator's rules check the values (`stop_conditions`).
         */
        StopRequest: {
            /**
             * @description Of the image, as in Progress, at most 1.
             * @default 0
             */
            relative_error?: number;
            /**
             * @description Of each tile, at most 1.
             * @default 0
             */
            tile_relative_error?: number;
            /**
             * @description Seconds of running, without pauses.
             * @default 0
             */
            wall_seconds?: number;
            /**
             * @description Processor seconds of workers.
             * @default 0
             */
            cpu_seconds?: number;
            /**
             * @description A time with its zone: "07:00 Europe/Berlin", "07:00+01:00", "2026-11-22T07:00:00Z".
             * @default
             */
            until?: string;
        };
        /** @description A tile that is being traced. */
        TileInProgress: {
            /** @description Its index, row by row over the film. */
            tile: number;
            /** @description Id of the worker that traces it. */
            worker: string;
        };
        /** @description Which tiles of a render have new samples: the data of an event `tiles`. */
        TilesEvent: {
            /** @description Its id. */
            render: string;
            /** @description The render's sequence. */
            revision: number;
            /** @description First and last indices of runs of tiles. */
            tiles: [
                number,
                number
            ][];
        };
        /** @description What is being traced of a render, as of the last two seconds. */
        TilesInProgress: {
            tiles: components["schemas"]["TileInProgress"][];
        };
        /**
         * @description An address that is told how its owner's renders end.
         * @example {
         *       "created": 1795305600,
         *       "id": "wh-5k2q",
         *       "last_outcome": "answered 204",
         *       "owner": "studio",
         *       "url": "https://example.org/nocturne"
         *     }
         */
        Webhook: {
            id: string;
            /** @description Name of the token that made it; empty without authentication. */
            owner: string;
            url: string;
            /** @description Unix time, seconds. */
            created: number;
            /** @description How the last message went, in words; empty before the first. */
            last_outcome: string;
        };
        /** @description Webhooks, oldest first. */
        WebhookList: {
            webhooks: components["schemas"]["Webhook"][];
        };
        /**
         * @description One worker process, as it last reported itself.
         * @example {
         *       "engine": 1,
         *       "floating_point_profile": "x86-64-avx2",
         *       "id": "w-7",
         *       "incompatible": "",
         *       "jobs_done": 240,
         *       "quarantine": "",
         *       "rays_per_second": 5000000,
         *       "started": 1795305000,
         *       "threads": 16
         *     }
         */
        Worker: {
            id: string;
            /** @description Version of the tracing engine; renders take results of one only. */
            engine: number;
            threads: number;
            /** @description Over the last seconds, all threads together. */
            rays_per_second: number;
            jobs_done: number;
            /** @description Unix time, seconds. */
            started: number;
            /** @description Why its results are refused; empty: they are taken. */
            quarantine: string;
            /** @description How it rounds; renders take results of one profile only. */
            floating_point_profile: string;
            /** @description Why it gets no jobs though it is not in quarantine; empty: it gets them. */
            incompatible: string;
        };
        /** @description What happened to a worker. */
        WorkerEvent: {
            unix_time: number;
            worker_id: string;
            /** @description joined, left, quarantined or released. */
            what: string;
            reason: string;
        };
        /** @description Worker events of late, and the rate of all workers. */
        WorkerHistory: {
            /** @description The last 100, newest first. */
            events: components["schemas"]["WorkerEvent"][];
            /** @description One for each minute of two days, oldest first. */
            rates: components["schemas"]["RatePoint"][];
        };
        /** @description The workers heard of in the last ten seconds. */
        WorkerList: {
            workers: components["schemas"]["Worker"][];
        };
        /**
         * AbovePlane
         * @description Altitude is the distance from a plane.
         */
        "Scene.AbovePlane": {
            /**
             * Point
             * @description A point of the plane.
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            point?: [
                number,
                number,
                number
            ];
            /**
             * Up
             * @description Its normal, of any length but 0.
             * @default [
             *       0,
             *       1,
             *       0
             *     ]
             */
            up?: [
                number,
                number,
                number
            ];
        };
        /**
         * AboveSphere
         * @description Altitude is the distance from a sphere.
         */
        "Scene.AboveSphere": {
            /**
             * Centre
             * @description Centre.
             */
            centre: [
                number,
                number,
                number
            ];
            /**
             * Radius
             * @description Radius, m.
             */
            radius: number;
        };
        /**
         * Aperture
         * @description A lens opening with straight edges: a regular polygon with its corners on the lens's circle.
         */
        "Scene.Aperture": {
            /**
             * Blades
             * @description Number of edges.
             */
            blades: number;
            /**
             * Rotation Degrees
             * @description Of the first corner, from the image's right towards its top.
             * @default 0
             */
            rotation_degrees?: number;
        };
        /**
         * AssetMesh
         * @description Triangles from a file: Wavefront OBJ, PLY, STL, glTF 2.0 or GLB.
         *
         *     Its geometry is used, its texture coordinates where they are needed (of OBJ and PLY files), and its
         *     normals if `smooth`.
         *
         *     A file holds everything itself: material libraries are ignored, and a glTF file with buffers in other
         *     files is refused (GLB and embedded buffers are fine). Polygons are split into triangles, all parts are
         *     merged.
         */
        "Scene.AssetMesh": {
            /**
             * Type
             * @constant
             */
            type: "mesh";
            /**
             * Asset
             * @description `sha256:` and 64 hexadecimal digits of an uploaded file. The command line also takes a path relative to the document; it uploads the file and puts the digest here.
             */
            asset: string;
            /**
             * Format
             * @description Format of the file. Needed with a digest; with a path the default is the extension.
             * @default null
             */
            format?: ("obj" | "ply" | "stl" | "gltf" | "glb") | null;
            /**
             * Smooth
             * @description Shade with normals that are interpolated between vertices: those of the mesh where it has them, else the mean of the adjoining triangles'. `false`: flat triangles.
             * @default false
             */
            smooth?: boolean;
        };
        /**
         * Atmosphere
         * @description A planet with its air: a sphere of ground, and around it a shell of media without a visible boundary.
         *
         *     The scene stands on it, or above it. Add the Sun to `$.distant`; the sky beyond is black unless there is
         *     an environment.
         */
        "Scene.Atmosphere": {
            /**
             * Planet Radius
             * @description Radius of the planet, m.
             * @default 6371000
             */
            planet_radius?: number;
            /**
             * Thickness
             * @description Altitude where the air ends, m.
             * @default 100000
             */
            thickness?: number;
            /**
             * Altitude
             * @description Altitude of the scene's origin above the ground, m.
             * @default 0
             */
            altitude?: number;
            /**
             * Up
             * @description Away from the planet, of any length but 0.
             * @default [
             *       0,
             *       1,
             *       0
             *     ]
             */
            up?: [
                number,
                number,
                number
            ];
            /**
             * Ground Reflectance
             * @description Of the ground, an ideal diffuse reflector.
             * @default 0.1
             */
            ground_reflectance?: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            /**
             * @description `null`: none.
             * @default {
             *       "pressure": 101325,
             *       "scale_height": 8449.5
             *     }
             */
            air?: components["schemas"]["Scene.AtmosphericAir"] | null;
            /**
             * @description Default: none.
             * @default null
             */
            ozone?: components["schemas"]["Scene.AtmosphericOzone"] | null;
            /**
             * @description Default: none.
             * @default null
             */
            aerosol?: components["schemas"]["Scene.AtmosphericAerosol"] | null;
        };
        /**
         * AtmosphericAerosol
         * @description Haze, whose density falls exponentially with altitude.
         */
        "Scene.AtmosphericAerosol": {
            /**
             * name
             * @description A name from `$.media`, whose `density` is not used: the optical depth says how much.
             */
            medium: string;
            /**
             * Optical Depth
             * @description Straight up, at 550 nm.
             */
            optical_depth: number;
            /**
             * Scale Height
             * @description Altitude over which the density falls to 1 / e, m.
             * @default 1200
             */
            scale_height?: number;
        };
        /**
         * AtmosphericAir
         * @description Clean air, whose density falls exponentially with altitude.
         *
         *     The density at the ground follows from the pressure, so that the optical depth straight up is that of
         *     Bodhaine et al. 1999, 0.0971 at 550 nm and sea level, whatever the scale height.
         */
        "Scene.AtmosphericAir": {
            /**
             * Pressure
             * @description Pressure on the ground, Pa.
             * @default 101325
             */
            pressure?: number;
            /**
             * Scale Height
             * @description Altitude over which the density falls to 1 / e, m. The default gives the ground the density of air at 15 degrees Celsius.
             * @default 8449.5
             */
            scale_height?: number;
        };
        /**
         * AtmosphericOzone
         * @description Absorbs yellow and red: without it the evening sky is not blue.
         *
         *     Its density rises from 10 km to 25 km and falls to 40 km; cross-sections at 233 K (Gorshelev et al.,
         *     Serdyuchenko et al. 2014).
         */
        "Scene.AtmosphericOzone": {
            /**
             * Dobson Units
             * @description The whole column, in Dobson units (0.01 mm of gas).
             * @default 300
             */
            dobson_units?: number;
        };
        /**
         * BlackbodySpectrum
         * @description Radiance of a black body, by Planck's law in vacuum, absolute unless `luminance` is given.
         */
        "Scene.BlackbodySpectrum": {
            /**
             * Blackbody
             * @description Temperature, K.
             */
            blackbody: number;
            /**
             * Luminance
             * @description Only for radiance: scales the spectrum so that it has this luminance, cd/m². Photometry by the CIE 1931 2° observer.
             * @default null
             */
            luminance?: number | null;
        };
        /**
         * Blend
         * @description Two kernels, each for a part of the light.
         */
        "Scene.Blend": {
            /**
             * Type
             * @constant
             */
            type: "blend";
            /**
             * First
             * @description A name from `$.kernels` or a kernel.
             */
            first: string | components["schemas"]["Scene.Lambertian"] | components["schemas"]["Scene.DiffuseTransmitter"] | components["schemas"]["Scene.Conductor"] | components["schemas"]["Scene.Dielectric"] | components["schemas"]["Scene.ThinPane"] | components["schemas"]["Scene.CoatedDiffuse"] | components["schemas"]["Scene.Phong"] | components["schemas"]["Scene.Measured"] | components["schemas"]["Scene.Blend"] | components["schemas"]["Scene.Mask"] | components["schemas"]["Scene.TwoSided"] | components["schemas"]["Scene.Passage"];
            /**
             * Second
             * @description The same.
             */
            second: string | components["schemas"]["Scene.Lambertian"] | components["schemas"]["Scene.DiffuseTransmitter"] | components["schemas"]["Scene.Conductor"] | components["schemas"]["Scene.Dielectric"] | components["schemas"]["Scene.ThinPane"] | components["schemas"]["Scene.CoatedDiffuse"] | components["schemas"]["Scene.Phong"] | components["schemas"]["Scene.Measured"] | components["schemas"]["Scene.Blend"] | components["schemas"]["Scene.Mask"] | components["schemas"]["Scene.TwoSided"] | components["schemas"]["Scene.Passage"];
            /**
             * Weight
             * @description Part of `second`, in [0, 1]; `first` has the rest.
             */
            weight: number | components["schemas"]["Scene.ScalarTexture"];
        };
        /**
         * Box
         * @description A box along the axes. Its normals point outwards.
         */
        "Scene.Box": {
            /**
             * Type
             * @constant
             */
            type: "box";
            /**
             * Minimum
             * @description The corner with the smallest coordinates.
             */
            minimum: [
                number,
                number,
                number
            ];
            /**
             * Maximum
             * @description The corner with the largest coordinates.
             */
            maximum: [
                number,
                number,
                number
            ];
        };
        /**
         * BumpMap
         * @description Shading normals from heights; of a colour image the luminance is taken.
         */
        "Scene.BumpMap": {
            /**
             * Texture
             * @description A name from `$.textures`, or a texture.
             */
            texture: string | components["schemas"]["Scene.Texture"];
            /**
             * Scale
             * @description How often the image is repeated along u and v.
             * @default [
             *       1,
             *       1
             *     ]
             */
            scale?: [
                number,
                number
            ];
            /**
             * Offset
             * @description Shift along u and v.
             * @default [
             *       0,
             *       0
             *     ]
             */
            offset?: [
                number,
                number
            ];
            /**
             * Height
             * @description Height that the value 1 stands for, m; 0 is the surface itself.
             */
            height: number;
        };
        /**
         * CauchyIndex
         * @description n = A + B / l² + C / l⁴, l in µm.
         */
        "Scene.CauchyIndex": {
            /**
             * Cauchy
             * @description A, B (µm²), C (µm⁴); one to three of them.
             */
            cauchy: number[];
        };
        /**
         * ChartSpectrum
         * @description The reflectance of a patch of the 24-patch colour chart (the mean of 30 charts, BabelColor 2012).
         */
        "Scene.ChartSpectrum": {
            /**
             * Chart Patch
             * @description Which one.
             * @enum {string}
             */
            chart_patch: "dark skin" | "light skin" | "blue sky" | "foliage" | "blue flower" | "bluish green" | "orange" | "purplish blue" | "moderate red" | "purple" | "yellow green" | "orange yellow" | "blue" | "green" | "red" | "yellow" | "magenta" | "cyan" | "white" | "neutral 8" | "neutral 6.5" | "neutral 5" | "neutral 3.5" | "black";
        };
        /**
         * CoatedDiffuse
         * @description A dielectric layer over an ideal diffuse base, on both sides of the surface: plastic, tiles.
         */
        "Scene.CoatedDiffuse": {
            /**
             * Roughness
             * @description Alpha of the microfacets, in [0, 1]; 0 is polished. Default: 0.
             * @default null
             */
            roughness?: (number | components["schemas"]["Scene.ScalarTexture"]) | null;
            /**
             * Roughness U
             * @description Alpha along the surface's u, instead of `roughness`.
             * @default null
             */
            roughness_u?: (number | components["schemas"]["Scene.ScalarTexture"]) | null;
            /**
             * Roughness V
             * @description Alpha along v.
             * @default null
             */
            roughness_v?: (number | components["schemas"]["Scene.ScalarTexture"]) | null;
            /**
             * Distribution
             * @description Of the microfacets' normals: `ggx` has the long tails of most real surfaces, `beckmann` normally distributed slopes, alpha being sqrt 2 times their standard deviation.
             * @default ggx
             * @enum {string}
             */
            distribution?: "ggx" | "beckmann";
            /**
             * Type
             * @constant
             */
            type: "coated_diffuse";
            /**
             * Index
             * @description Index of refraction of the layer.
             */
            index: string | number | components["schemas"]["Scene.SellmeierIndex"] | components["schemas"]["Scene.CauchyIndex"] | components["schemas"]["Scene.TableIndex"];
            /**
             * Reflectance
             * @description Of the base alone, in [0, 1].
             */
            reflectance: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"] | components["schemas"]["Scene.ColourTexture"];
        };
        /**
         * ColourTexture
         * @description A spectrum that varies over a surface: `spectrum` times what the texture holds.
         *
         *     A colour image's texels (sRGB primaries) become the smooth spectra of Jakob and Hanika (2019); those of a
         *     grey image are plain factors.
         */
        "Scene.ColourTexture": {
            /**
             * Texture
             * @description A name from `$.textures`, or a texture.
             */
            texture: string | components["schemas"]["Scene.Texture"];
            /**
             * Scale
             * @description How often the image is repeated along u and v.
             * @default [
             *       1,
             *       1
             *     ]
             */
            scale?: [
                number,
                number
            ];
            /**
             * Offset
             * @description Shift along u and v.
             * @default [
             *       0,
             *       0
             *     ]
             */
            offset?: [
                number,
                number
            ];
            /**
             * Spectrum
             * @description What the texture is multiplied with: for a luminaire, its radiance.
             * @default 1
             */
            spectrum?: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            /**
             * Grey
             * @description Use the texture's luminance, as a factor.
             * @default false
             */
            grey?: boolean;
        };
        /**
         * ComplexIndex
         * @description The index of refraction n + i k of a metal.
         */
        "Scene.ComplexIndex": {
            /**
             * N
             * @description Real part.
             */
            n: string | number | components["schemas"]["Scene.SellmeierIndex"] | components["schemas"]["Scene.CauchyIndex"] | components["schemas"]["Scene.TableIndex"];
            /**
             * K
             * @description Imaginary part, the extinction coefficient; not negative.
             */
            k: number | components["schemas"]["Scene.TableExtinction"];
        };
        /**
         * Conductor
         * @description A metal, polished or rough (microfacets).
         */
        "Scene.Conductor": {
            /**
             * Roughness
             * @description Alpha of the microfacets, in [0, 1]; 0 is polished. Default: 0.
             * @default null
             */
            roughness?: (number | components["schemas"]["Scene.ScalarTexture"]) | null;
            /**
             * Roughness U
             * @description Alpha along the surface's u, instead of `roughness`.
             * @default null
             */
            roughness_u?: (number | components["schemas"]["Scene.ScalarTexture"]) | null;
            /**
             * Roughness V
             * @description Alpha along v.
             * @default null
             */
            roughness_v?: (number | components["schemas"]["Scene.ScalarTexture"]) | null;
            /**
             * Distribution
             * @description Of the microfacets' normals: `ggx` has the long tails of most real surfaces, `beckmann` normally distributed slopes, alpha being sqrt 2 times their standard deviation.
             * @default ggx
             * @enum {string}
             */
            distribution?: "ggx" | "beckmann";
            /**
             * Type
             * @constant
             */
            type: "conductor";
            /**
             * Index
             * @description Index of refraction n + i k, against vacuum.
             */
            index: string | components["schemas"]["Scene.ComplexIndex"];
        };
        /**
         * ConstantEnvironment
         * @description The same radiance from all directions, infinitely far away.
         */
        "Scene.ConstantEnvironment": {
            /**
             * Radiance
             * @description Spectral radiance, W m⁻² sr⁻¹ nm⁻¹.
             */
            radiance: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
        };
        /**
         * ConstantSpectrum
         * @description The same value at every wavelength. A bare number means the same as `{"constant": number}`.
         */
        "Scene.ConstantSpectrum": {
            /**
             * Constant
             * @description Reflectance in [0, 1], or radiance in W m⁻² sr⁻¹ nm⁻¹.
             */
            constant: number;
            /**
             * Luminance
             * @description Only for radiance: scales the spectrum so that it has this luminance, cd/m². Photometry by the CIE 1931 2° observer.
             * @default null
             */
            luminance?: number | null;
        };
        /**
         * CosineProfile
         * @description Radiance falls with a power of the cosine of the angle to the normal: 0 is an ideal diffuse lamp.
         */
        "Scene.CosineProfile": {
            /**
             * Cosine Power
             * @description The power.
             */
            cosine_power: number;
        };
        /**
         * Dielectric
         * @description The boundary of a transparent body, polished or rough (microfacets): glass, water, diamond.
         *
         *     What the surface encloses, on the side that the normal points away from, is the body. Bodies may overlap:
         *     where they do, the one with the higher `priority` is there, so a drink reaches a little into its glass.
         */
        "Scene.Dielectric": {
            /**
             * Roughness
             * @description Alpha of the microfacets, in [0, 1]; 0 is polished. Default: 0.
             * @default null
             */
            roughness?: (number | components["schemas"]["Scene.ScalarTexture"]) | null;
            /**
             * Roughness U
             * @description Alpha along the surface's u, instead of `roughness`.
             * @default null
             */
            roughness_u?: (number | components["schemas"]["Scene.ScalarTexture"]) | null;
            /**
             * Roughness V
             * @description Alpha along v.
             * @default null
             */
            roughness_v?: (number | components["schemas"]["Scene.ScalarTexture"]) | null;
            /**
             * Distribution
             * @description Of the microfacets' normals: `ggx` has the long tails of most real surfaces, `beckmann` normally distributed slopes, alpha being sqrt 2 times their standard deviation.
             * @default ggx
             * @enum {string}
             */
            distribution?: "ggx" | "beckmann";
            /**
             * Type
             * @constant
             */
            type: "dielectric";
            /**
             * Index
             * @description Index of refraction of the body.
             */
            index: string | number | components["schemas"]["Scene.SellmeierIndex"] | components["schemas"]["Scene.CauchyIndex"] | components["schemas"]["Scene.TableIndex"];
            /**
             * Absorption
             * @description Absorption coefficient inside, 1/m: a constant or a table. Default: none.
             * @default null
             */
            absorption?: (string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"]) | null;
            /**
             * Priority
             * @description Which of overlapping bodies counts: the one with the highest number.
             * @default 0
             */
            priority?: number;
        };
        /**
         * DiffuseTransmitter
         * @description Paper, leaf or cloth: diffuse on both sides, to the side that light comes from and to the other.
         */
        "Scene.DiffuseTransmitter": {
            /**
             * Type
             * @constant
             */
            type: "diffuse_transmitter";
            /**
             * Reflectance
             * @description Fraction of the light that is reflected, in [0, 1] at every wavelength.
             */
            reflectance: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"] | components["schemas"]["Scene.ColourTexture"];
            /**
             * Transmittance
             * @description Fraction that goes through; with the reflectance at most 1 at every wavelength.
             */
            transmittance: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"] | components["schemas"]["Scene.ColourTexture"];
        };
        /**
         * Disc
         * @description A flat disc, made of `segments` triangles around its centre.
         *
         *     Its corners lie on the circle, so its area is too small by a part of 6.58 / segments²: 1.0e-4 with 256,
         *     6.3e-6 with 1024. Texture coordinates run from 0 to 1 across it.
         */
        "Scene.Disc": {
            /**
             * Type
             * @constant
             */
            type: "disc";
            /**
             * Centre
             * @description Centre.
             */
            centre: [
                number,
                number,
                number
            ];
            /**
             * Normal
             * @description Direction of the normal, of any length but 0.
             */
            normal: [
                number,
                number,
                number
            ];
            /**
             * Radius
             * @description Radius, more than 0.
             */
            radius: number;
            /**
             * Segments
             * @description Corners on the circle.
             * @default 256
             */
            segments?: number;
        };
        /**
         * DistantDisc
         * @description A disc at infinity, such as the Sun. Give one of `radiance`, `irradiance` and `sun`.
         */
        "Scene.DistantDisc": {
            /**
             * Direction
             * @description Towards the disc, of any length but 0.
             */
            direction: [
                number,
                number,
                number
            ];
            /**
             * Angular Diameter Degrees
             * @description Its size in the sky, at least 0.01. Default: that of the Sun, 0.533.
             * @default null
             */
            angular_diameter_degrees?: number | null;
            /**
             * Radiance
             * @description Spectral radiance at the disc's centre, W m⁻² sr⁻¹ nm⁻¹.
             * @default null
             */
            radiance?: (string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"]) | null;
            /**
             * Irradiance
             * @description Spectral irradiance of a surface that faces the disc, W m⁻² nm⁻¹.
             * @default null
             */
            irradiance?: (string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"]) | null;
            /**
             * Sun
             * @description The spectrum of the Sun above the atmosphere (ASTM G173-03), with its irradiance at the Earth's mean distance.
             * @default false
             */
            sun?: boolean;
            /**
             * Limb Darkening
             * @description Darker towards the edge, by wavelength, as the Sun is.
             * @default false
             */
            limb_darkening?: boolean;
        };
        /**
         * DoubleHenyeyGreensteinPhase
         * @description Two Henyey-Greenstein functions, each for a part of the light.
         */
        "Scene.DoubleHenyeyGreensteinPhase": {
            /**
             * Type
             * @constant
             */
            type: "double_henyey_greenstein";
            /**
             * First
             * @description Mean cosine of the first.
             */
            first: number;
            /**
             * Second
             * @description Mean cosine of the second.
             */
            second: number;
            /**
             * Weight
             * @description Part of the first; the second has the rest.
             */
            weight: number;
        };
        /**
         * Droplets
         * @description Clear spheres of many sizes: n(r) in proportion to r^alpha exp(-(alpha / gamma) (r / mode)^gamma).
         *
         *     The modified gamma distribution (D. Deirmendjian, "Electromagnetic scattering on spherical
         *     polydispersions", 1969). How they scatter is computed by Mie's theory when the scene is compiled: for 21
         *     wavelengths, linear in between.
         */
        "Scene.Droplets": {
            /**
             * Mode Radius
             * @description The most frequent radius, m.
             */
            mode_radius: number;
            /**
             * Alpha
             * @description Exponent of the small droplets.
             */
            alpha: number;
            /**
             * Gamma
             * @description Exponent of the large droplets' decline.
             * @default 1
             */
            gamma?: number;
            /**
             * Number
             * @description Droplets in a cubic metre where the density is 1. Without effect on a phase function.
             * @default 100000000
             */
            number?: number;
            /**
             * Index
             * @description Index of refraction.
             * @default water
             */
            index?: string | number | components["schemas"]["Scene.SellmeierIndex"] | components["schemas"]["Scene.CauchyIndex"] | components["schemas"]["Scene.TableIndex"];
        };
        /**
         * EnvironmentMap
         * @description Light from infinitely far away, from an image of all directions (latitude and longitude).
         *
         *     The image's rows go from `up` to its opposite; its middle column is `forward`, and to the right of that is
         *     what is to the right for someone who looks along `forward` with `up` upwards. It is resampled to rows of
         *     equal steps of height (an equal-area cylindrical map).
         */
        "Scene.EnvironmentMap": {
            /**
             * Asset
             * @description A Radiance HDR or OpenEXR image, linear sRGB: a path relative to the document, or `sha256:` and its digest.
             */
            asset: string;
            /**
             * Luminance
             * @description Luminance of a white texel of value 1, cd/m²; its spectrum is D65. Other colours get smooth spectra (Jakob and Hanika 2019).
             * @default 1
             */
            luminance?: number;
            /**
             * Up
             * @description Direction of the image's top edge.
             * @default [
             *       0,
             *       1,
             *       0
             *     ]
             */
            up?: [
                number,
                number,
                number
            ];
            /**
             * Forward
             * @description Direction of the image's middle; what of it is along `up` is left out.
             * @default [
             *       0,
             *       0,
             *       -1
             *     ]
             */
            forward?: [
                number,
                number,
                number
            ];
            /**
             * Rotate Degrees
             * @description Turn of the map about `up`, counter-clockwise seen from above.
             * @default 0
             */
            rotate_degrees?: number;
        };
        /**
         * ExponentialDensity
         * @description `at_ground` times exp(-altitude / scale height), also below the ground.
         */
        "Scene.ExponentialDensity": {
            /**
             * Scale Height
             * @description Altitude over which the density falls to 1 / e, m.
             */
            scale_height: number;
            /**
             * At Ground
             * @description Density at altitude 0.
             * @default 1
             */
            at_ground?: number;
            /**
             * Above
             * @description What altitude is measured from. Default: the plane y = 0.
             * @default {
             *       "point": [
             *         0,
             *         0,
             *         0
             *       ],
             *       "up": [
             *         0,
             *         1,
             *         0
             *       ]
             *     }
             */
            above?: components["schemas"]["Scene.AbovePlane"] | components["schemas"]["Scene.AboveSphere"];
        };
        /**
         * Grid
         * @description A grid of an OpenVDB file, with 32-bit floats; where it is sparse it stays sparse.
         *
         *     The file's own transform places voxels; then come `scale`, `rotate` and `translate`. It stands in the
         *     scene, also where the surface that bounds it is in a group.
         */
        "Scene.Grid": {
            /**
             * Scale
             * @description Factor for all lengths, more than 0; 0.001 for a file in millimetres.
             * @default 1
             */
            scale?: number;
            /**
             * @description Rotation about the origin.
             * @default null
             */
            rotate?: components["schemas"]["Scene.Rotation"] | null;
            /**
             * Translate
             * @description Shift, m.
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            translate?: [
                number,
                number,
                number
            ];
            /**
             * Asset
             * @description The .vdb file: a path relative to the document, or `sha256:` and its digest.
             */
            asset: string;
            /**
             * Grid
             * @description Name of the grid in the file.
             */
            grid: string;
            /**
             * Factor
             * @description Factor of the values.
             * @default 1
             */
            factor?: number;
            /**
             * Nearest
             * @description `true`: constant over a voxel. `false`: linear between voxel centres.
             * @default false
             */
            nearest?: boolean;
        };
        /**
         * HenyeyGreensteinPhase
         * @description L. G. Henyey and J. L. Greenstein, Astrophysical Journal 93, 1941.
         */
        "Scene.HenyeyGreensteinPhase": {
            /**
             * Type
             * @constant
             */
            type: "henyey_greenstein";
            /**
             * G
             * @description Mean cosine of the scattering angle; positive is forwards.
             */
            g: number;
        };
        /**
         * IlluminantSpectrum
         * @description A CIE illuminant (CIE 015:2018).
         *
         *     It has a shape and no size, so as radiance it needs `luminance`.
         */
        "Scene.IlluminantSpectrum": {
            /**
             * Illuminant
             * @description Which one.
             * @enum {string}
             */
            illuminant: "A" | "C" | "D50" | "D55" | "D65" | "D75" | "E" | "FL1" | "FL2" | "FL3" | "FL4" | "FL5" | "FL6" | "FL7" | "FL8" | "FL9" | "FL10" | "FL11" | "FL12" | "FL3.1" | "FL3.2" | "FL3.3" | "FL3.4" | "FL3.5" | "FL3.6" | "FL3.7" | "FL3.8" | "FL3.9" | "FL3.10" | "FL3.11" | "FL3.12" | "FL3.13" | "FL3.14" | "FL3.15" | "HP1" | "HP2" | "HP3" | "HP4" | "HP5" | "LED-B1" | "LED-B2" | "LED-B3" | "LED-B4" | "LED-B5" | "LED-BH1" | "LED-RGB1" | "LED-V1" | "LED-V2";
            /**
             * Luminance
             * @description Only for radiance: scales the spectrum so that it has this luminance, cd/m². Photometry by the CIE 1931 2° observer.
             * @default null
             */
            luminance?: number | null;
        };
        /**
         * ImportantDirection
         * @description A shape that is worth looking at from everywhere, such as the opening of a reflector.
         *
         *     It is no part of the scene: it only says where photons are sent more often.
         */
        "Scene.ImportantDirection": {
            /**
             * Scale
             * @description Factor for all lengths, more than 0; 0.001 for a file in millimetres.
             * @default 1
             */
            scale?: number;
            /**
             * @description Rotation about the origin.
             * @default null
             */
            rotate?: components["schemas"]["Scene.Rotation"] | null;
            /**
             * Translate
             * @description Shift, m.
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            translate?: [
                number,
                number,
                number
            ];
            /**
             * Shape
             * @description The shape; seen from both sides.
             */
            shape: components["schemas"]["Scene.InlineMesh"] | components["schemas"]["Scene.AssetMesh"] | components["schemas"]["Scene.Quad"] | components["schemas"]["Scene.Sphere"] | components["schemas"]["Scene.Disc"] | components["schemas"]["Scene.Box"] | components["schemas"]["Scene.MediumBox"];
            /**
             * Weight
             * @description Relative to the other important directions.
             * @default 1
             */
            weight?: number;
        };
        /**
         * InlineMesh
         * @description Triangles written in the document itself; for more than a few thousand, use a file.
         */
        "Scene.InlineMesh": {
            /**
             * Type
             * @constant
             */
            type: "mesh";
            /**
             * Vertices
             * @description Positions `[x, y, z]`.
             */
            vertices: [
                number,
                number,
                number
            ][];
            /**
             * Triangles
             * @description Triples of indices into `vertices`, from 0. Counter-clockwise seen from the side that the normal points to.
             */
            triangles: [
                number,
                number,
                number
            ][];
            /**
             * Normals
             * @description A direction for each vertex, for `smooth`.
             * @default null
             */
            normals?: [
                number,
                number,
                number
            ][] | null;
            /**
             * Texture Coordinates
             * @description `[u, v]` for each vertex.
             * @default null
             */
            texture_coordinates?: [
                number,
                number
            ][] | null;
            /**
             * Smooth
             * @description Shade with normals that are interpolated between vertices: those of the mesh where it has them, else the mean of the adjoining triangles'. `false`: flat triangles.
             * @default false
             */
            smooth?: boolean;
        };
        /**
         * Instance
         * @description All surfaces of a group once more, without taking their memory again.
         *
         *     Groups can hold instances of other groups. Of an instance and those around it only one may move; surfaces
         *     of a group may move as well.
         */
        "Scene.Instance": {
            /**
             * Scale
             * @description Factor for all lengths, more than 0; 0.001 for a file in millimetres.
             * @default 1
             */
            scale?: number;
            /**
             * @description Rotation about the origin.
             * @default null
             */
            rotate?: components["schemas"]["Scene.Rotation"] | null;
            /**
             * Translate
             * @description Shift, m.
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            translate?: [
                number,
                number,
                number
            ];
            /**
             * Motion
             * @description Movement while the shutter is open; comes after the placement.
             * @default null
             */
            motion?: (components["schemas"]["Scene.RigidMotion"] | components["schemas"]["Scene.KeyedMotion"]) | null;
            /**
             * Name
             * @description For people; not part of the compiled scene.
             * @default
             */
            name?: string;
            /**
             * name
             * @description A name from `$.groups`.
             */
            group: string;
        };
        /**
         * IntensityMeter
         * @description The luminous intensity of a lamp in all directions, far away from it: Y is in cd.
         *
         *     Columns are equal steps of the horizontal angle from 0 to 360 degrees, rows equal steps of the vertical
         *     angle from `axis` (0) to its opposite (180). The lamp is all that is inside a sphere; light from outside
         *     passes by. `nocturne ies` writes the image as a photometric file, which a luminaire's profile can be.
         */
        "Scene.IntensityMeter": {
            /**
             * Observer
             * @description Whose colour matching functions X, Y and Z are.
             * @default CIE 1931 2 degree
             * @enum {string}
             */
            observer?: "CIE 1931 2 degree" | "CIE 1964 10 degree";
            /**
             * Responses
             * @description Further channels by name: response per unit of spectral radiance and nanometre, zero beyond a table. They are resolved to 1 nm: what is narrower or steeper keeps its integral and its centre, and becomes as wide.
             * @default {}
             */
            responses?: {
                [key: string]: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            };
            /**
             * Wavelengths
             * @description How a photon's wavelength is drawn: in proportion to X + Y + Z of the observer (a further response counts as much as these), or uniformly from 360 to 830 nm. Both give the same image; `response` with less noise. Where something emits lines narrower than 5 nm, `response` draws half of the photons for lines: each emission spectrum that has such lines gets an equal part.
             * @default response
             * @enum {string}
             */
            wavelengths?: "response" | "uniform";
            /**
             * Motion
             * @description Movement while the shutter is open; placements without `scale`.
             * @default null
             */
            motion?: (components["schemas"]["Scene.RigidMotion"] | components["schemas"]["Scene.KeyedMotion"]) | null;
            /**
             * Type
             * @constant
             */
            type: "intensity_meter";
            /**
             * Position
             * @description Centre of the sphere that holds the lamp, m.
             */
            position: [
                number,
                number,
                number
            ];
            /**
             * Lamp Radius
             * @description Radius of that sphere, m.
             */
            lamp_radius: number;
            /**
             * Axis
             * @description Direction of vertical angle 0.
             * @default [
             *       0,
             *       -1,
             *       0
             *     ]
             */
            axis?: [
                number,
                number,
                number
            ];
            /**
             * Zero
             * @description Direction of horizontal angle 0; what of it is along the axis is left out. Angles increase counter-clockwise for someone who looks along `axis`.
             * @default [
             *       1,
             *       0,
             *       0
             *     ]
             */
            zero?: [
                number,
                number,
                number
            ];
        };
        /**
         * Interior
         * @description What fills the body that a closed surface encloses, on the side that the normal points away from.
         *
         *     With a dielectric kernel, the media fill that body. With any other kernel, or none, the body has the index
         *     of refraction of what is around it: its boundary is not seen, unless the kernel is. Such bodies overlap
         *     each other freely, and their media add up; a dielectric body keeps out those of no higher priority.
         */
        "Scene.Interior": {
            /**
             * Media
             * @description Names from `$.media`: all of them fill the body.
             */
            media: string[];
            /**
             * Priority
             * @description Without a dielectric kernel, which has its own: media stay inside of dielectric bodies of a lower priority only. Default: 0.
             * @default null
             */
            priority?: number | null;
        };
        /**
         * IrradianceMeter
         * @description A flat film that light falls on. A pixel is the irradiance on it: Y is the illuminance in lx.
         */
        "Scene.IrradianceMeter": {
            /**
             * Observer
             * @description Whose colour matching functions X, Y and Z are.
             * @default CIE 1931 2 degree
             * @enum {string}
             */
            observer?: "CIE 1931 2 degree" | "CIE 1964 10 degree";
            /**
             * Responses
             * @description Further channels by name: response per unit of spectral radiance and nanometre, zero beyond a table. They are resolved to 1 nm: what is narrower or steeper keeps its integral and its centre, and becomes as wide.
             * @default {}
             */
            responses?: {
                [key: string]: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            };
            /**
             * Wavelengths
             * @description How a photon's wavelength is drawn: in proportion to X + Y + Z of the observer (a further response counts as much as these), or uniformly from 360 to 830 nm. Both give the same image; `response` with less noise. Where something emits lines narrower than 5 nm, `response` draws half of the photons for lines: each emission spectrum that has such lines gets an equal part.
             * @default response
             * @enum {string}
             */
            wavelengths?: "response" | "uniform";
            /**
             * Motion
             * @description Movement while the shutter is open; placements without `scale`.
             * @default null
             */
            motion?: (components["schemas"]["Scene.RigidMotion"] | components["schemas"]["Scene.KeyedMotion"]) | null;
            /**
             * Type
             * @constant
             */
            type: "irradiance_meter";
            /**
             * Position
             * @description The film's centre, m.
             */
            position: [
                number,
                number,
                number
            ];
            /**
             * Normal
             * @description Direction that the film faces.
             * @default null
             */
            normal?: [
                number,
                number,
                number
            ] | null;
            /**
             * Look At
             * @description A point that the film faces, instead of `normal`.
             * @default null
             */
            look_at?: [
                number,
                number,
                number
            ] | null;
            /**
             * Up
             * @description Upwards in the image. Default: y, or z where the film faces along y.
             * @default null
             */
            up?: [
                number,
                number,
                number
            ] | null;
            /**
             * Height
             * @description Height of the film, m; its width follows from the image's shape.
             */
            height: number;
        };
        /**
         * IsotropicPhase
         * @description The same in all directions.
         */
        "Scene.IsotropicPhase": {
            /**
             * Type
             * @constant
             */
            type: "isotropic";
        };
        /**
         * KeyedMotion
         * @description Placements at equally spaced times, from when the shutter opens to when it closes.
         *
         *     Each comes after the thing's own placement; in between, points move in straight lines.
         */
        "Scene.KeyedMotion": {
            /**
             * Placements
             * @description At least two.
             */
            placements: components["schemas"]["Scene.Placement"][];
        };
        /**
         * Lambertian
         * @description An ideal diffuse reflector, on both sides of the surface: it looks equally bright from everywhere.
         */
        "Scene.Lambertian": {
            /**
             * Type
             * @constant
             */
            type: "lambertian";
            /**
             * Reflectance
             * @description Fraction of the light that is reflected, in [0, 1] at every wavelength.
             */
            reflectance: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"] | components["schemas"]["Scene.ColourTexture"];
        };
        /**
         * LayeredDensity
         * @description A density that depends on altitude, linear between those given; nothing beyond.
         */
        "Scene.LayeredDensity": {
            /**
             * Layers
             * @description Pairs `[altitude in m, density]`, altitudes increasing.
             */
            layers: [
                number,
                number
            ][];
            /**
             * Above
             * @description What altitude is measured from. Default: the plane y = 0.
             * @default {
             *       "point": [
             *         0,
             *         0,
             *         0
             *       ],
             *       "up": [
             *         0,
             *         1,
             *         0
             *       ]
             *     }
             */
            above?: components["schemas"]["Scene.AbovePlane"] | components["schemas"]["Scene.AboveSphere"];
        };
        /**
         * LineSpectrum
         * @description Light of a gas discharge or a laser: lines, each a triangle over wavelength.
         *
         *     The triangle has its full width at half of its height, twice that at its foot; its area is the power.
         *     Lines may overlap. Those that lie outside of 360 to 830 nm are left out. However narrow a line is, it
         *     needs no more photons than other light does: see the sensor's `wavelengths`.
         */
        "Scene.LineSpectrum": {
            /**
             * Lines
             * @description The lines.
             */
            lines: components["schemas"]["Scene.SpectralLine"][];
            /**
             * Luminance
             * @description Only for radiance: scales the spectrum so that it has this luminance, cd/m². Photometry by the CIE 1931 2° observer.
             * @default null
             */
            luminance?: number | null;
        };
        /**
         * Luminaire
         * @description What makes a surface emit light.
         */
        "Scene.Luminaire": {
            /**
             * Radiance
             * @description Spectral radiance, W m⁻² sr⁻¹ nm⁻¹.
             */
            radiance: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"] | components["schemas"]["Scene.ColourTexture"];
            /**
             * Two Sided
             * @description Emit from both sides; otherwise only from the side that the normal points to.
             * @default false
             */
            two_sided?: boolean;
            /**
             * Profile
             * @description How the radiance depends on direction. Default: the same in all directions.
             * @default null
             */
            profile?: (components["schemas"]["Scene.CosineProfile"] | components["schemas"]["Scene.PhotometricProfile"]) | null;
        };
        /**
         * Mask
         * @description A kernel that is only partly there: the rest of the light goes straight through.
         */
        "Scene.Mask": {
            /**
             * Type
             * @constant
             */
            type: "mask";
            /**
             * Kernel
             * @description A name from `$.kernels` or a kernel.
             */
            kernel: string | components["schemas"]["Scene.Lambertian"] | components["schemas"]["Scene.DiffuseTransmitter"] | components["schemas"]["Scene.Conductor"] | components["schemas"]["Scene.Dielectric"] | components["schemas"]["Scene.ThinPane"] | components["schemas"]["Scene.CoatedDiffuse"] | components["schemas"]["Scene.Phong"] | components["schemas"]["Scene.Measured"] | components["schemas"]["Scene.Blend"] | components["schemas"]["Scene.Mask"] | components["schemas"]["Scene.TwoSided"] | components["schemas"]["Scene.Passage"];
            /**
             * Opacity
             * @description Part that is there, in [0, 1].
             */
            opacity: number | components["schemas"]["Scene.ScalarTexture"];
        };
        /**
         * Measured
         * @description A measured, isotropic reflection: a MERL file, or a spectral table in the half-angle frame.
         *
         *     The table's layout: docs/how-to/measured-brdf.md.
         */
        "Scene.Measured": {
            /**
             * Type
             * @constant
             */
            type: "measured";
            /**
             * Asset
             * @description The file: a path relative to the document, or `sha256:` and its digest.
             */
            asset: string;
            /**
             * Format
             * @description Which of the two.
             * @enum {string}
             */
            format: "merl" | "table";
        };
        /**
         * Medium
         * @description What fills space and is hit by chance: fog, smoke, air, milk.
         *
         *     What it does to light comes from one of three: `absorption` and `scattering`, a `preset`, or `droplets`.
         *     Coefficients are per metre where the density is 1; spectra of any kind but those of light.
         */
        "Scene.Medium": {
            /**
             * Preset
             * @description A published medium, with its phase function.
             * @default null
             */
            preset?: ("air" | "fog" | "coastal haze" | "continental haze" | "whole milk" | "skimmed milk" | "marble" | "skin 1" | "skin 2" | "dermis" | "light epidermis" | "moderate epidermis" | "dark epidermis") | null;
            /**
             * @description Fog or haze by Mie's theory.
             * @default null
             */
            droplets?: components["schemas"]["Scene.Droplets"] | null;
            /**
             * Absorption
             * @description Absorption coefficient, 1/m. Default: none.
             * @default null
             */
            absorption?: (string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"]) | null;
            /**
             * Scattering
             * @description Scattering coefficient, 1/m. Default: none.
             * @default null
             */
            scattering?: (string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"]) | null;
            /**
             * Phase
             * @description How directions change, for `scattering`. Default: isotropic.
             * @default null
             */
            phase?: (components["schemas"]["Scene.IsotropicPhase"] | components["schemas"]["Scene.HenyeyGreensteinPhase"] | components["schemas"]["Scene.DoubleHenyeyGreensteinPhase"] | components["schemas"]["Scene.RayleighPhase"] | components["schemas"]["Scene.TabulatedPhase"] | components["schemas"]["Scene.MiePhase"]) | null;
            /**
             * Density
             * @description Factor of the coefficients: a number, by altitude, or a grid.
             * @default 1
             */
            density?: number | components["schemas"]["Scene.ExponentialDensity"] | components["schemas"]["Scene.LayeredDensity"] | components["schemas"]["Scene.Grid"];
            /**
             * @description Kelvin. The medium glows as a black body wherever it absorbs.
             * @default null
             */
            temperature?: components["schemas"]["Scene.Grid"] | null;
            /**
             * Emission Scale
             * @description Factor of the glow, with `temperature`. Default: 1.
             * @default null
             */
            emission_scale?: number | null;
        };
        /**
         * MediumBox
         * @description The box around what a medium's grid holds, with room for its linear interpolation.
         *
         *     It stands as the grid stands, so it has no placement of its own, and no place in a group. Its normals
         *     point outwards.
         */
        "Scene.MediumBox": {
            /**
             * Type
             * @constant
             */
            type: "medium_box";
            /**
             * name
             * @description A name from `$.media`, whose `density` is a grid.
             */
            medium: string;
        };
        /**
         * MiePhase
         * @description That of droplets, for coefficients of your own.
         */
        "Scene.MiePhase": {
            /**
             * Type
             * @constant
             */
            type: "mie";
            /** @description The droplets. */
            droplets: components["schemas"]["Scene.Droplets"];
        };
        /**
         * Mixture
         * @description Weights of the ways to choose a direction; scaled so that they sum to 1.
         *
         *     The weights change the noise and not the image, as long as `kernel` or `uniform` is more than 0: without
         *     both, light that other surfaces scatter is lost. A way with weight 0 is never used, nor is one that the
         *     scene has nothing for. If none of `luminaires`, `environment` and `important` is given, those that the
         *     scene has share 0.35 in equal parts; if some are given, the others are 0.
         */
        "Scene.Mixture": {
            /**
             * Kernel
             * @description In proportion to the kernel.
             * @default 0.65
             */
            kernel?: number;
            /**
             * Luminaires
             * @description Towards the luminaires on surfaces.
             * @default null
             */
            luminaires?: number | null;
            /**
             * Environment
             * @description In proportion to the environment, and towards discs at infinity.
             * @default null
             */
            environment?: number | null;
            /**
             * Important
             * @description Towards `$.important_directions`.
             * @default null
             */
            important?: number | null;
            /**
             * Uniform
             * @description Uniformly over the directions that the surface scatters to.
             * @default 0
             */
            uniform?: number;
        };
        /**
         * NormalMap
         * @description Shading normals: x, y, z stored as 0.5 + 0.5 n, x along u, y along v. Never sRGB-encoded.
         */
        "Scene.NormalMap": {
            /**
             * Texture
             * @description A name from `$.textures`, or a texture.
             */
            texture: string | components["schemas"]["Scene.Texture"];
            /**
             * Scale
             * @description How often the image is repeated along u and v.
             * @default [
             *       1,
             *       1
             *     ]
             */
            scale?: [
                number,
                number
            ];
            /**
             * Offset
             * @description Shift along u and v.
             * @default [
             *       0,
             *       0
             *     ]
             */
            offset?: [
                number,
                number
            ];
        };
        /**
         * Orthographic
         * @description A camera that sees everything from the same direction: parallel lines stay parallel.
         */
        "Scene.Orthographic": {
            /**
             * Observer
             * @description Whose colour matching functions X, Y and Z are.
             * @default CIE 1931 2 degree
             * @enum {string}
             */
            observer?: "CIE 1931 2 degree" | "CIE 1964 10 degree";
            /**
             * Responses
             * @description Further channels by name: response per unit of spectral radiance and nanometre, zero beyond a table. They are resolved to 1 nm: what is narrower or steeper keeps its integral and its centre, and becomes as wide.
             * @default {}
             */
            responses?: {
                [key: string]: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            };
            /**
             * Wavelengths
             * @description How a photon's wavelength is drawn: in proportion to X + Y + Z of the observer (a further response counts as much as these), or uniformly from 360 to 830 nm. Both give the same image; `response` with less noise. Where something emits lines narrower than 5 nm, `response` draws half of the photons for lines: each emission spectrum that has such lines gets an equal part.
             * @default response
             * @enum {string}
             */
            wavelengths?: "response" | "uniform";
            /**
             * Motion
             * @description Movement while the shutter is open; placements without `scale`.
             * @default null
             */
            motion?: (components["schemas"]["Scene.RigidMotion"] | components["schemas"]["Scene.KeyedMotion"]) | null;
            /**
             * Position
             * @description Where the sensor is, m.
             */
            position: [
                number,
                number,
                number
            ];
            /**
             * Look At
             * @description A point in the middle of the image.
             */
            look_at: [
                number,
                number,
                number
            ];
            /**
             * Up
             * @description A direction that is upwards in the image; not along the view.
             * @default [
             *       0,
             *       1,
             *       0
             *     ]
             */
            up?: [
                number,
                number,
                number
            ];
            /**
             * Type
             * @constant
             */
            type: "orthographic";
            /**
             * Height
             * @description Height of what is seen, m; the width follows from the image's shape.
             */
            height: number;
        };
        /**
         * Panorama
         * @description All directions in one image.
         *
         *     Columns are equal steps of azimuth with `look_at` in the middle, rows equal steps of the angle from `up`
         *     down. `look_at` gives the azimuth only.
         */
        "Scene.Panorama": {
            /**
             * Observer
             * @description Whose colour matching functions X, Y and Z are.
             * @default CIE 1931 2 degree
             * @enum {string}
             */
            observer?: "CIE 1931 2 degree" | "CIE 1964 10 degree";
            /**
             * Responses
             * @description Further channels by name: response per unit of spectral radiance and nanometre, zero beyond a table. They are resolved to 1 nm: what is narrower or steeper keeps its integral and its centre, and becomes as wide.
             * @default {}
             */
            responses?: {
                [key: string]: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            };
            /**
             * Wavelengths
             * @description How a photon's wavelength is drawn: in proportion to X + Y + Z of the observer (a further response counts as much as these), or uniformly from 360 to 830 nm. Both give the same image; `response` with less noise. Where something emits lines narrower than 5 nm, `response` draws half of the photons for lines: each emission spectrum that has such lines gets an equal part.
             * @default response
             * @enum {string}
             */
            wavelengths?: "response" | "uniform";
            /**
             * Motion
             * @description Movement while the shutter is open; placements without `scale`.
             * @default null
             */
            motion?: (components["schemas"]["Scene.RigidMotion"] | components["schemas"]["Scene.KeyedMotion"]) | null;
            /**
             * Position
             * @description Where the sensor is, m.
             */
            position: [
                number,
                number,
                number
            ];
            /**
             * Look At
             * @description A point in the middle of the image.
             */
            look_at: [
                number,
                number,
                number
            ];
            /**
             * Up
             * @description A direction that is upwards in the image; not along the view.
             * @default [
             *       0,
             *       1,
             *       0
             *     ]
             */
            up?: [
                number,
                number,
                number
            ];
            /**
             * Type
             * @constant
             */
            type: "panorama";
        };
        /**
         * Passage
         * @description Nothing: light goes straight through. For shapes that only emit.
         */
        "Scene.Passage": {
            /**
             * Type
             * @constant
             */
            type: "passage";
        };
        /**
         * Phong
         * @description A cosine lobe around the mirror direction, (n + 2) / 2π cosⁿ, times the reflectance.
         */
        "Scene.Phong": {
            /**
             * Type
             * @constant
             */
            type: "phong";
            /**
             * Reflectance
             * @description Fraction of the light that is reflected, in [0, 1] at every wavelength.
             */
            reflectance: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"] | components["schemas"]["Scene.ColourTexture"];
            /**
             * Exponent
             * @description n.
             */
            exponent: number;
        };
        /**
         * PhotometricProfile
         * @description The intensity that a photometric file (IES LM-63, type C) gives, spread over the surface's area.
         *
         *     Of the luminaire's `radiance` only the spectrum's shape counts then: the candelas are the file's. The
         *     surface's shape is a quad, a disc, a flat mesh or a sphere.
         */
        "Scene.PhotometricProfile": {
            /**
             * Asset
             * @description The file: a path relative to the document, or `sha256:` and its digest.
             */
            asset: string;
            /**
             * Lumens
             * @description Scale the intensities to this luminous flux, lm. Default: as in the file.
             * @default null
             */
            lumens?: number | null;
            /**
             * Axis
             * @description Direction of vertical angle 0, before the surface's rotation.
             * @default [
             *       0,
             *       -1,
             *       0
             *     ]
             */
            axis?: [
                number,
                number,
                number
            ];
            /**
             * Zero
             * @description Direction of horizontal angle 0; what of it is along the axis is left out. Angles increase counter-clockwise for someone who looks along `axis`, such as down on a lamp.
             * @default [
             *       1,
             *       0,
             *       0
             *     ]
             */
            zero?: [
                number,
                number,
                number
            ];
        };
        /**
         * Pinhole
         * @description A camera whose opening is a point: everything is sharp.
         */
        "Scene.Pinhole": {
            /**
             * Observer
             * @description Whose colour matching functions X, Y and Z are.
             * @default CIE 1931 2 degree
             * @enum {string}
             */
            observer?: "CIE 1931 2 degree" | "CIE 1964 10 degree";
            /**
             * Responses
             * @description Further channels by name: response per unit of spectral radiance and nanometre, zero beyond a table. They are resolved to 1 nm: what is narrower or steeper keeps its integral and its centre, and becomes as wide.
             * @default {}
             */
            responses?: {
                [key: string]: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            };
            /**
             * Wavelengths
             * @description How a photon's wavelength is drawn: in proportion to X + Y + Z of the observer (a further response counts as much as these), or uniformly from 360 to 830 nm. Both give the same image; `response` with less noise. Where something emits lines narrower than 5 nm, `response` draws half of the photons for lines: each emission spectrum that has such lines gets an equal part.
             * @default response
             * @enum {string}
             */
            wavelengths?: "response" | "uniform";
            /**
             * Motion
             * @description Movement while the shutter is open; placements without `scale`.
             * @default null
             */
            motion?: (components["schemas"]["Scene.RigidMotion"] | components["schemas"]["Scene.KeyedMotion"]) | null;
            /**
             * Position
             * @description Where the sensor is, m.
             */
            position: [
                number,
                number,
                number
            ];
            /**
             * Look At
             * @description A point in the middle of the image.
             */
            look_at: [
                number,
                number,
                number
            ];
            /**
             * Up
             * @description A direction that is upwards in the image; not along the view.
             * @default [
             *       0,
             *       1,
             *       0
             *     ]
             */
            up?: [
                number,
                number,
                number
            ];
            /**
             * Vertical Field Of View Degrees
             * @description Full angle between the image's top and bottom edges. The horizontal one follows from the image's shape.
             */
            vertical_field_of_view_degrees: number;
            /**
             * Type
             * @constant
             */
            type: "pinhole";
        };
        /**
         * Placement
         * @description Where a thing stands. `scale` comes first, then `rotate`, then `translate`.
         */
        "Scene.Placement": {
            /**
             * Scale
             * @description Factor for all lengths, more than 0; 0.001 for a file in millimetres.
             * @default 1
             */
            scale?: number;
            /**
             * @description Rotation about the origin.
             * @default null
             */
            rotate?: components["schemas"]["Scene.Rotation"] | null;
            /**
             * Translate
             * @description Shift, m.
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            translate?: [
                number,
                number,
                number
            ];
        };
        /**
         * Quad
         * @description The parallelogram `corner + s edge_u + t edge_v` for s and t in [0, 1].
         *
         *     Its normal points along `edge_u` x `edge_v`.
         */
        "Scene.Quad": {
            /**
             * Type
             * @constant
             */
            type: "quad";
            /**
             * Corner
             * @description A corner.
             */
            corner: [
                number,
                number,
                number
            ];
            /**
             * Edge U
             * @description From the corner along one side.
             */
            edge_u: [
                number,
                number,
                number
            ];
            /**
             * Edge V
             * @description From the corner along the other side.
             */
            edge_v: [
                number,
                number,
                number
            ];
        };
        /**
         * RadianceMeter
         * @description The mean radiance over a small disc and a narrow cone: Y is the luminance in cd/m².
         *
         *     All pixels measure the same.
         */
        "Scene.RadianceMeter": {
            /**
             * Observer
             * @description Whose colour matching functions X, Y and Z are.
             * @default CIE 1931 2 degree
             * @enum {string}
             */
            observer?: "CIE 1931 2 degree" | "CIE 1964 10 degree";
            /**
             * Responses
             * @description Further channels by name: response per unit of spectral radiance and nanometre, zero beyond a table. They are resolved to 1 nm: what is narrower or steeper keeps its integral and its centre, and becomes as wide.
             * @default {}
             */
            responses?: {
                [key: string]: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            };
            /**
             * Wavelengths
             * @description How a photon's wavelength is drawn: in proportion to X + Y + Z of the observer (a further response counts as much as these), or uniformly from 360 to 830 nm. Both give the same image; `response` with less noise. Where something emits lines narrower than 5 nm, `response` draws half of the photons for lines: each emission spectrum that has such lines gets an equal part.
             * @default response
             * @enum {string}
             */
            wavelengths?: "response" | "uniform";
            /**
             * Motion
             * @description Movement while the shutter is open; placements without `scale`.
             * @default null
             */
            motion?: (components["schemas"]["Scene.RigidMotion"] | components["schemas"]["Scene.KeyedMotion"]) | null;
            /**
             * Position
             * @description Where the sensor is, m.
             */
            position: [
                number,
                number,
                number
            ];
            /**
             * Look At
             * @description A point in the middle of the image.
             */
            look_at: [
                number,
                number,
                number
            ];
            /**
             * Up
             * @description A direction that is upwards in the image; not along the view.
             * @default [
             *       0,
             *       1,
             *       0
             *     ]
             */
            up?: [
                number,
                number,
                number
            ];
            /**
             * Type
             * @constant
             */
            type: "radiance_meter";
            /**
             * Diameter
             * @description Of the disc around `position` from which it looks, m.
             */
            diameter: number;
            /**
             * Cone Degrees
             * @description Full angle of the cone around the direction of view.
             */
            cone_degrees: number;
        };
        /**
         * RayleighPhase
         * @description Molecules, and whatever is far smaller than the wavelength; unpolarised light.
         */
        "Scene.RayleighPhase": {
            /**
             * Type
             * @constant
             */
            type: "rayleigh";
            /**
             * Depolarisation
             * @description Depolarisation ratio for natural light, in [0, 1).
             * @default 0
             */
            depolarisation?: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
        };
        /**
         * RgbSpectrum
         * @description The smooth spectrum of a colour (Jakob and Hanika 2019), in linear light with the primaries of sRGB.
         *
         *     As reflectance the values lie in [0, 1], and a white surface has (1, 1, 1) under D65. As radiance it needs
         *     `luminance`, and (1, 1, 1) is D65.
         */
        "Scene.RgbSpectrum": {
            /**
             * Rgb
             * @description Red, green and blue, linear.
             */
            rgb: [
                number,
                number,
                number
            ];
            /**
             * Luminance
             * @description Only for radiance: scales the spectrum so that it has this luminance, cd/m². Photometry by the CIE 1931 2° observer.
             * @default null
             */
            luminance?: number | null;
        };
        /**
         * RigidMotion
         * @description How a thing moves while the shutter is open, at constant speed: first `rotate`, then `translate`.
         *
         *     A rotation becomes straight pieces, none of which is farther from its arc than 1/3000 of the distance to
         *     the axis.
         */
        "Scene.RigidMotion": {
            /**
             * @description Rotation over the whole shutter interval.
             * @default null
             */
            rotate?: components["schemas"]["Scene.Turn"] | null;
            /**
             * Translate
             * @description Shift over the whole shutter interval, m.
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            translate?: [
                number,
                number,
                number
            ];
        };
        /**
         * Rotation
         * @description A rotation about an axis through the origin, counter-clockwise seen against the axis (right-handed).
         */
        "Scene.Rotation": {
            /**
             * Axis
             * @description Direction of the axis, of any length but 0.
             */
            axis: [
                number,
                number,
                number
            ];
            /**
             * Degrees
             * @description Angle, degrees.
             */
            degrees: number;
        };
        /**
         * ScalarTexture
         * @description A number that varies over a surface: the texture's value times `gain` plus `bias`, kept in [0, 1].
         *
         *     Of a colour image it is the luminance.
         */
        "Scene.ScalarTexture": {
            /**
             * Texture
             * @description A name from `$.textures`, or a texture.
             */
            texture: string | components["schemas"]["Scene.Texture"];
            /**
             * Scale
             * @description How often the image is repeated along u and v.
             * @default [
             *       1,
             *       1
             *     ]
             */
            scale?: [
                number,
                number
            ];
            /**
             * Offset
             * @description Shift along u and v.
             * @default [
             *       0,
             *       0
             *     ]
             */
            offset?: [
                number,
                number
            ];
            /**
             * Gain
             * @description Factor.
             * @default 1
             */
            gain?: number;
            /**
             * Bias
             * @description What is added.
             * @default 0
             */
            bias?: number;
        };
        /**
         * SellmeierCoefficients
         * @description Coefficients as glass makers print them, for wavelengths in micrometres.
         */
        "Scene.SellmeierCoefficients": {
            /**
             * B
             * @description B1, B2, B3.
             */
            b: [
                number,
                number,
                number
            ];
            /**
             * C
             * @description C1, C2, C3, µm².
             */
            c: [
                number,
                number,
                number
            ];
        };
        /**
         * SellmeierIndex
         * @description n² = 1 + sum of B l² / (l² - C), l in µm: the dispersion formula of most glass catalogues.
         */
        "Scene.SellmeierIndex": {
            /** @description The coefficients. */
            sellmeier: components["schemas"]["Scene.SellmeierCoefficients"];
        };
        /**
         * SpectralLine
         * @description One line. Nothing is infinitely thin, so it has a width.
         */
        "Scene.SpectralLine": {
            /**
             * Nm
             * @description Its middle, nm.
             */
            nm: number;
            /**
             * Power
             * @description The line's radiance, W m⁻² sr⁻¹; with `luminance` only the lines' proportions count.
             */
            power: number;
            /**
             * Width
             * @description Full width at half maximum, nm.
             * @default 0.1
             */
            width?: number;
        };
        /**
         * Sphere
         * @description A sphere. Its normal points outwards.
         *
         *     Texture coordinates: u is the angle about z, from x towards y, over a full turn; v goes from the lowest
         *     point (0) to the highest (1) in equal steps of angle, where z is up. `rotate` turns both with the surface.
         */
        "Scene.Sphere": {
            /**
             * Type
             * @constant
             */
            type: "sphere";
            /**
             * Centre
             * @description Centre.
             */
            centre: [
                number,
                number,
                number
            ];
            /**
             * Radius
             * @description Radius, more than 0.
             */
            radius: number;
        };
        /**
         * Surface
         * @description A shape, where it stands, what it is made of and whether it emits.
         *
         *     `scale` comes first, then `rotate`, then `translate`.
         */
        "Scene.Surface": {
            /**
             * Scale
             * @description Factor for all lengths, more than 0; 0.001 for a file in millimetres.
             * @default 1
             */
            scale?: number;
            /**
             * @description Rotation about the origin.
             * @default null
             */
            rotate?: components["schemas"]["Scene.Rotation"] | null;
            /**
             * Translate
             * @description Shift, m.
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            translate?: [
                number,
                number,
                number
            ];
            /**
             * Motion
             * @description Movement while the shutter is open; comes after the placement.
             * @default null
             */
            motion?: (components["schemas"]["Scene.RigidMotion"] | components["schemas"]["Scene.KeyedMotion"]) | null;
            /**
             * Name
             * @description For people; not part of the compiled scene.
             * @default
             */
            name?: string;
            /**
             * Shape
             * @description The geometry.
             */
            shape: components["schemas"]["Scene.InlineMesh"] | components["schemas"]["Scene.AssetMesh"] | components["schemas"]["Scene.Quad"] | components["schemas"]["Scene.Sphere"] | components["schemas"]["Scene.Disc"] | components["schemas"]["Scene.Box"] | components["schemas"]["Scene.MediumBox"];
            /**
             * Kernel
             * @description How the surface scatters light: a name from `$.kernels` or a kernel. Without one, and with an interior, it is the boundary of media, and not seen.
             * @default null
             */
            kernel?: (string | components["schemas"]["Scene.Lambertian"] | components["schemas"]["Scene.DiffuseTransmitter"] | components["schemas"]["Scene.Conductor"] | components["schemas"]["Scene.Dielectric"] | components["schemas"]["Scene.ThinPane"] | components["schemas"]["Scene.CoatedDiffuse"] | components["schemas"]["Scene.Phong"] | components["schemas"]["Scene.Measured"] | components["schemas"]["Scene.Blend"] | components["schemas"]["Scene.Mask"] | components["schemas"]["Scene.TwoSided"] | components["schemas"]["Scene.Passage"]) | null;
            /**
             * @description Media that fill what it encloses.
             * @default null
             */
            interior?: components["schemas"]["Scene.Interior"] | null;
            /**
             * @description Present if the surface emits light.
             * @default null
             */
            luminaire?: components["schemas"]["Scene.Luminaire"] | null;
            /**
             * @description Shading normals from a texture.
             * @default null
             */
            normal_map?: components["schemas"]["Scene.NormalMap"] | null;
            /**
             * @description Shading normals from a texture of heights.
             * @default null
             */
            bump_map?: components["schemas"]["Scene.BumpMap"] | null;
        };
        /**
         * TableExtinction
         * @description Measured extinction coefficients k, linear between neighbours; beyond the table the end value holds.
         */
        "Scene.TableExtinction": {
            /**
             * Table
             * @description Pairs `[wavelength in nm, k]`, wavelengths increasing.
             */
            table: [
                number,
                number
            ][];
        };
        /**
         * TableIndex
         * @description Measured indices, linear between neighbours; beyond the table the end value holds.
         */
        "Scene.TableIndex": {
            /**
             * Table
             * @description Pairs `[wavelength in nm, index]`, wavelengths increasing.
             */
            table: [
                number,
                number
            ][];
        };
        /**
         * TableSpectrum
         * @description Measured or computed values, linear between neighbours.
         *
         *     Compiled to the coarsest of the steps 100, 50, 20, 10, 5, 4, 2, 1, 0.5, 0.2, 0.1, 0.05, 0.02 and 0.01 nm
         *     on which every knot lies, so that nothing is lost. A table whose knots lie on none of them is sampled each
         *     0.1 nm from its first knot: the value is then exact at the samples, elsewhere wrong by at most 0.025 nm
         *     times the change of slope at a knot in between, and the end is rounded up to the next sample.
         */
        "Scene.TableSpectrum": {
            /**
             * Table
             * @description Pairs `[wavelength in nm, value]`, wavelengths increasing. Values are reflectance in [0, 1], or radiance in W m⁻² sr⁻¹ nm⁻¹.
             */
            table: [
                number,
                number
            ][];
            /**
             * Outside
             * @description Beyond the first and last knot: `hold` the end value, or `zero`. Default: `hold` for reflectance, `zero` for radiance.
             * @default null
             */
            outside?: ("hold" | "zero") | null;
            /**
             * Luminance
             * @description Only for radiance: scales the spectrum so that it has this luminance, cd/m². Photometry by the CIE 1931 2° observer.
             * @default null
             */
            luminance?: number | null;
        };
        /**
         * TabulatedPhase
         * @description Measured or computed values, linear between cosines and between wavelengths; of any scale.
         */
        "Scene.TabulatedPhase": {
            /**
             * Type
             * @constant
             */
            type: "tabulated";
            /**
             * Cosines
             * @description Cosines of the scattering angle, increasing from -1 (back) to 1 (on).
             */
            cosines: number[];
            /**
             * Wavelengths
             * @description Increasing; the first and last hold beyond. One: the same for all.
             * @default [
             *       550
             *     ]
             */
            wavelengths?: number[];
            /**
             * Values
             * @description A list for each wavelength, with a value for each cosine; not all zero.
             */
            values: number[][];
        };
        /**
         * Texture
         * @description An image that varies a value over a surface. Any format that OpenImageIO reads, such as PNG or EXR.
         *
         *     u goes from the image's left edge (0) to its right (1), v from its bottom edge up to its top.
         */
        "Scene.Texture": {
            /**
             * Asset
             * @description The image file: a path relative to the document, or `sha256:` and its digest.
             */
            asset: string;
            /**
             * Encoding
             * @description How stored numbers stand for light: by the sRGB curve, or in proportion. Default: `sRGB` for colours, unless the file holds floating-point numbers; `linear` for all else.
             * @default null
             */
            encoding?: ("sRGB" | "linear") | null;
            /**
             * Wrap
             * @description Beyond the image's edges: repeat it, or hold the edge.
             * @default repeat
             * @enum {string}
             */
            wrap?: "repeat" | "clamp";
            /**
             * Sharp
             * @description Use the image as it is at every point, instead of its mean over what a photon covers: for edges that must not be blurred.
             * @default false
             */
            sharp?: boolean;
        };
        /**
         * ThinLens
         * @description A camera with an ideal lens: sharp at one distance only.
         */
        "Scene.ThinLens": {
            /**
             * Observer
             * @description Whose colour matching functions X, Y and Z are.
             * @default CIE 1931 2 degree
             * @enum {string}
             */
            observer?: "CIE 1931 2 degree" | "CIE 1964 10 degree";
            /**
             * Responses
             * @description Further channels by name: response per unit of spectral radiance and nanometre, zero beyond a table. They are resolved to 1 nm: what is narrower or steeper keeps its integral and its centre, and becomes as wide.
             * @default {}
             */
            responses?: {
                [key: string]: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
            };
            /**
             * Wavelengths
             * @description How a photon's wavelength is drawn: in proportion to X + Y + Z of the observer (a further response counts as much as these), or uniformly from 360 to 830 nm. Both give the same image; `response` with less noise. Where something emits lines narrower than 5 nm, `response` draws half of the photons for lines: each emission spectrum that has such lines gets an equal part.
             * @default response
             * @enum {string}
             */
            wavelengths?: "response" | "uniform";
            /**
             * Motion
             * @description Movement while the shutter is open; placements without `scale`.
             * @default null
             */
            motion?: (components["schemas"]["Scene.RigidMotion"] | components["schemas"]["Scene.KeyedMotion"]) | null;
            /**
             * Position
             * @description Where the sensor is, m.
             */
            position: [
                number,
                number,
                number
            ];
            /**
             * Look At
             * @description A point in the middle of the image.
             */
            look_at: [
                number,
                number,
                number
            ];
            /**
             * Up
             * @description A direction that is upwards in the image; not along the view.
             * @default [
             *       0,
             *       1,
             *       0
             *     ]
             */
            up?: [
                number,
                number,
                number
            ];
            /**
             * Vertical Field Of View Degrees
             * @description Full angle between the image's top and bottom edges. The horizontal one follows from the image's shape.
             */
            vertical_field_of_view_degrees: number;
            /**
             * Type
             * @constant
             */
            type: "thin_lens";
            /**
             * Lens Radius
             * @description Radius of the lens, m.
             */
            lens_radius: number;
            /**
             * Focus Distance
             * @description Distance of the sharp plane, m, along the direction of view.
             */
            focus_distance: number;
            /**
             * @description Shape of the opening. Default: round.
             * @default null
             */
            aperture?: components["schemas"]["Scene.Aperture"] | null;
        };
        /**
         * ThinPane
         * @description A thin plane sheet of glass as one surface: all inner reflections, without the offset of the light.
         */
        "Scene.ThinPane": {
            /**
             * Type
             * @constant
             */
            type: "thin_pane";
            /**
             * Index
             * @description Index of refraction of the sheet.
             */
            index: string | number | components["schemas"]["Scene.SellmeierIndex"] | components["schemas"]["Scene.CauchyIndex"] | components["schemas"]["Scene.TableIndex"];
            /**
             * Transmittance
             * @description Internal transmittance of one crossing at normal incidence, in [0, 1].
             * @default 1
             */
            transmittance?: string | number | components["schemas"]["Scene.ConstantSpectrum"] | components["schemas"]["Scene.TableSpectrum"] | components["schemas"]["Scene.BlackbodySpectrum"] | components["schemas"]["Scene.IlluminantSpectrum"] | components["schemas"]["Scene.LineSpectrum"] | components["schemas"]["Scene.RgbSpectrum"] | components["schemas"]["Scene.ChartSpectrum"];
        };
        /**
         * Tracing
         * @description How photons are traced. None of it changes what the image converges to, except `maximum_depth`.
         */
        "Scene.Tracing": {
            /**
             * H
             * @description Scales the probability min(1, H h) that a photon survives at a surface of albedo H. 4 unless given; 1 with roulette by albedo, where more would keep photons for ever.
             * @default null
             */
            h?: number | null;
            /**
             * Roulette
             * @description Survival by H h times the weight that the photon carries, or by H h alone (the paper).
             * @default weight
             * @enum {string}
             */
            roulette?: "weight" | "albedo";
            /**
             * Roulette After
             * @description Interactions that every photon survives; then roulette starts.
             * @default 2
             */
            roulette_after?: number;
            /**
             * Maximum Depth
             * @description Interactions with surfaces and media after which a photon is absorbed; what it passes straight through, as a pane or a mask, does not count. Default: 1000; none in a scene with media, where a photon ends by leaving, or by roulette once absorption has made it light.
             * @default null
             */
            maximum_depth?: number | null;
            /**
             * Estimator
             * @description What goes on from a vertex: two photons, one from the kernel and one towards luminaires or important directions that ends on the first ordinary surface; or one, drawn from the mixture; or one of each way at the first vertices, with power-heuristic weights.
             * @default two_photons
             * @enum {string}
             */
            estimator?: "two_photons" | "mixture" | "split";
            /**
             * Split Vertices
             * @description At how many vertices the estimator `"split"` splits.
             * @default 1
             */
            split_vertices?: number;
            /**
             * @description How directions are chosen.
             * @default {
             *       "kernel": 0.65,
             *       "luminaires": null,
             *       "environment": null,
             *       "important": null,
             *       "uniform": 0
             *     }
             */
            mixture?: components["schemas"]["Scene.Mixture"];
            /**
             * Photons Together
             * @description Photons of different wavelengths that travel together as long as nothing parts them. `auto`: 1 where a body's index of refraction depends on wavelength, and for `forward` with media, else 4.
             * @default auto
             * @enum {unknown}
             */
            photons_together?: "auto" | 1 | 4 | 8;
            /**
             * Direction
             * @description From the sensor to the luminaires, or the other way round. `forward` is for the irradiance meter and the intensity meter. `both` is for cameras: photons from the luminaires bring the light that mirrors and glass gather, as from lamps in reflectors and in caustics, and photons from the camera find all other light. Neither is for luminaires with textures.
             * @default adjoint
             * @enum {string}
             */
            direction?: "adjoint" | "forward" | "both";
            /**
             * Aimed Emission
             * @description For photons from luminaires on surfaces, with `forward` and `both`: the part that is sent towards `$.important_directions`, such as glass that makes a caustic. The others leave as the luminaire emits, so that no light is lost.
             * @default 0
             */
            aimed_emission?: number;
            /**
             * Sequence
             * @description Random numbers: Owen-scrambled Sobol points for each pixel, or independent ones.
             * @default sobol
             * @enum {string}
             */
            sequence?: "sobol" | "independent";
            /**
             * Seed
             * @description Chooses the random numbers of the whole image.
             * @default 0
             */
            seed?: number;
        };
        /**
         * Turn
         * @description A rotation about any axis while the shutter is open, at most one full turn.
         */
        "Scene.Turn": {
            /**
             * Axis
             * @description Direction of the axis, of any length but 0.
             */
            axis: [
                number,
                number,
                number
            ];
            /**
             * Degrees
             * @description Angle, degrees.
             */
            degrees: number;
            /**
             * About
             * @description A point on the axis, m.
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            about?: [
                number,
                number,
                number
            ];
        };
        /**
         * TwoSided
         * @description A kernel for each side of the surface. Neither can be a dielectric: a boundary has both sides.
         */
        "Scene.TwoSided": {
            /**
             * Type
             * @constant
             */
            type: "two_sided";
            /**
             * Front
             * @description For light on the side that the normal points to.
             */
            front: string | components["schemas"]["Scene.Lambertian"] | components["schemas"]["Scene.DiffuseTransmitter"] | components["schemas"]["Scene.Conductor"] | components["schemas"]["Scene.Dielectric"] | components["schemas"]["Scene.ThinPane"] | components["schemas"]["Scene.CoatedDiffuse"] | components["schemas"]["Scene.Phong"] | components["schemas"]["Scene.Measured"] | components["schemas"]["Scene.Blend"] | components["schemas"]["Scene.Mask"] | components["schemas"]["Scene.TwoSided"] | components["schemas"]["Scene.Passage"];
            /**
             * Back
             * @description For light on the other side.
             */
            back: string | components["schemas"]["Scene.Lambertian"] | components["schemas"]["Scene.DiffuseTransmitter"] | components["schemas"]["Scene.Conductor"] | components["schemas"]["Scene.Dielectric"] | components["schemas"]["Scene.ThinPane"] | components["schemas"]["Scene.CoatedDiffuse"] | components["schemas"]["Scene.Phong"] | components["schemas"]["Scene.Measured"] | components["schemas"]["Scene.Blend"] | components["schemas"]["Scene.Mask"] | components["schemas"]["Scene.TwoSided"] | components["schemas"]["Scene.Passage"];
        };
    };
    responses: {
        /** @description AMBIGUOUS_ID: Several ids begin so. */
        AMBIGUOUS_ID: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description CANT_PREFLIGHT: No preflight can be made. */
        CANT_PREFLIGHT: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description CONFLICT: In conflict with an earlier request. */
        CONFLICT: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description CONFLICT: In conflict with an earlier request; WRONG_STATE: Not in this state; AMBIGUOUS_ID: Several ids begin so. */
        "CONFLICT-WRONG_STATE-AMBIGUOUS_ID": {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description INTERNAL: Internal error. */
        INTERNAL: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description INVALID_INPUT: The request is not valid. */
        INVALID_INPUT: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description NOT_FOUND: Not found. */
        NOT_FOUND: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description OVERLOADED: Too much at once; STORE: The storage does not answer. */
        "OVERLOADED-STORE": {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
        "REFUSED-FORBIDDEN": {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description STORE: The storage does not answer. */
        STORE: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description TOO_MANY: Too many calls. */
        TOO_MANY: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description UNAUTHENTICATED: A known token is needed. */
        UNAUTHENTICATED: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description WRONG_STATE: Not in this state. */
        WRONG_STATE: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
        /** @description WRONG_STATE: Not in this state; AMBIGUOUS_ID: Several ids begin so. */
        "WRONG_STATE-AMBIGUOUS_ID": {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["ProblemDetails"];
            };
        };
    };
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type $defs = Record<string, never>;
export interface operations {
    list_renders: {
        parameters: {
            query?: {
                /** @description At most 200; 0 means 50. */
                page_size?: number;
                /** @description From the page before. */
                page_token?: string;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RenderPage"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    create_render: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CreateRenderRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Render"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description CONFLICT: In conflict with an earlier request. */
            409: components["responses"]["CONFLICT"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description OVERLOADED: Too much at once; STORE: The storage does not answer. */
            503: components["responses"]["OVERLOADED-STORE"];
        };
    };
    get_render: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Render"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    delete_render: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description WRONG_STATE: Not in this state. */
            409: components["responses"]["WRONG_STATE"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    replay_render: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ReplayRenderRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Render"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description CONFLICT: In conflict with an earlier request; WRONG_STATE: Not in this state; AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["CONFLICT-WRONG_STATE-AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    explain_render: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Explanation"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    get_tiles_in_progress: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TilesInProgress"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    get_convergence: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Convergence"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    cancel_render: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["RenderActionRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Render"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    pause_render: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["RenderActionRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Render"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description WRONG_STATE: Not in this state; AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["WRONG_STATE-AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    resume_render: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["RenderActionRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Render"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description WRONG_STATE: Not in this state; AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["WRONG_STATE-AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    extend_render: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ExtendRenderRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Render"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description WRONG_STATE: Not in this state; AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["WRONG_STATE-AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    set_priority: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SetPriorityRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Render"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    look_first: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["LookFirstRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Render"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    preflight: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PreflightRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PreflightReport"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description CANT_PREFLIGHT: No preflight can be made. */
            409: components["responses"]["CANT_PREFLIGHT"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description OVERLOADED: Too much at once; STORE: The storage does not answer. */
            503: components["responses"]["OVERLOADED-STORE"];
        };
    };
    get_preview: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description The picture. */
            200: {
                headers: {
                    /** @description Changes when the content does. */
                    ETag?: string;
                    [name: string]: unknown;
                };
                content: {
                    "image/png": string;
                };
            };
            /** @description Not changed since If-None-Match. */
            304: {
                headers: {
                    /** @description Changes when the content does. */
                    ETag?: string;
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    get_thumbnail: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description The picture. */
            200: {
                headers: {
                    /** @description Changes when the content does. */
                    ETag?: string;
                    [name: string]: unknown;
                };
                content: {
                    "image/png": string;
                };
            };
            /** @description Not changed since If-None-Match. */
            304: {
                headers: {
                    /** @description Changes when the content does. */
                    ETag?: string;
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    get_tiles: {
        parameters: {
            query?: {
                /** @description ETag of the answer before, without its quotes. */
                since?: string;
            };
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description The tiles, little-endian (docs/reference/api.md). */
            200: {
                headers: {
                    /** @description Changes when the content does. */
                    ETag?: string;
                    [name: string]: unknown;
                };
                content: {
                    "application/vnd.nocturne.tiles": string;
                };
            };
            /** @description Not changed since If-None-Match. */
            304: {
                headers: {
                    /** @description Changes when the content does. */
                    ETag?: string;
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    get_image: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description The image. */
            200: {
                headers: {
                    /** @description Changes when the content does. */
                    ETag?: string;
                    [name: string]: unknown;
                };
                content: {
                    "image/x-exr": string;
                };
            };
            /** @description Not changed since If-None-Match. */
            304: {
                headers: {
                    /** @description Changes when the content does. */
                    ETag?: string;
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description AMBIGUOUS_ID: Several ids begin so. */
            409: components["responses"]["AMBIGUOUS_ID"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    render_events: {
        parameters: {
            query?: never;
            header?: {
                "last-event-id"?: string;
            };
            path: {
                render_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/event-stream": unknown;
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    all_events: {
        parameters: {
            query?: {
                /** @description Only these, with their tiles. */
                render?: string[] | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/event-stream": unknown;
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    get_session: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    begin_session: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    end_session: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    missing_assets: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["BatchMissingRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BatchMissingResponse"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    store_asset: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                sha256: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/octet-stream": string;
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Asset"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    asset_size: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                sha256: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    list_workers: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["WorkerList"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    get_worker_history: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["WorkerHistory"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    release_worker: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                worker_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    list_webhooks: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["WebhookList"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    create_webhook: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CreateWebhookRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["NewWebhook"];
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    delete_webhook: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                webhook_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description NOT_FOUND: Not found. */
            404: components["responses"]["NOT_FOUND"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
    alive: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/plain": string;
                };
            };
        };
    };
    ready: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/plain": string;
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description OVERLOADED: Too much at once; STORE: The storage does not answer. */
            503: components["responses"]["OVERLOADED-STORE"];
        };
    };
    metrics: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/plain": string;
                };
            };
            /** @description UNAUTHENTICATED: A known token is needed. */
            401: components["responses"]["UNAUTHENTICATED"];
            /** @description REFUSED: Refused; FORBIDDEN: Not allowed. */
            403: components["responses"]["REFUSED-FORBIDDEN"];
            /** @description INVALID_INPUT: The request is not valid. */
            422: components["responses"]["INVALID_INPUT"];
            /** @description TOO_MANY: Too many calls. */
            429: components["responses"]["TOO_MANY"];
            /** @description INTERNAL: Internal error. */
            500: components["responses"]["INTERNAL"];
            /** @description STORE: The storage does not answer. */
            503: components["responses"]["STORE"];
        };
    };
}
